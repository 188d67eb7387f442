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


def moments_z(values, mean, variance):
    """The largest score of the means and variances of draws, one per row."""
    away = (values - values.mean(axis=0)) ** 2
    root = len(values) ** 0.5
    z = (values.mean(axis=0) - mean) / values.std(axis=0) * root
    return np.abs([z, (away.mean(axis=0) - variance) / away.std(axis=0) * root]).max()


def covariance_z(values, mean, covariance):
    """As `moments_z`, of the means and all covariances."""
    away = values - mean
    products = away[:, :, None] * away[:, None, :]
    of_mean, of_covariance = (
        (drawn.mean(axis=0) - expected) / drawn.std(axis=0) * len(values) ** 0.5
        for drawn, expected in ((away, 0.0), (products, covariance))
    )
    return max(np.abs(of_mean).max(), np.abs(of_covariance).max())
