"""How well draws follow a law, as scores that are normal if they do, or as chances."""

import numpy as np
from scipy import stats


def chi_square_score(found, share):
    """Of cells, whose shares add up to 1 (Wilson & Hilferty, PNAS 17 (1931) 684)."""
    chi2 = (found**2 / (share * found.sum())).sum() - found.sum()
    freedom = share.size - 1
    spread = 2 / (9 * freedom)
    return (np.cbrt(chi2 / freedom) - (1 - spread)) / np.sqrt(spread)


def kolmogorov_p_at(found_below, law, total):
    """Of the largest distance at some places; over all places it is larger still."""
    return stats.kstwobign.sf(np.abs(found_below / total - law).max() * np.sqrt(total))


def scores_of_moments(found, moment, total):
    """Scores of the first four moments about the true mean; ``moment`` to order 8."""
    orders = range(1, 5)
    spread = [np.sqrt((moment[2 * k] - moment[k] ** 2) / total) for k in orders]
    return np.array([(found[k] - moment[k]) / spread[k - 1] for k in orders])


def correlation_z(one, other):
    """Of values about 0."""
    return np.mean(one * other) / (one.std() * other.std()) * np.sqrt(one.size)
