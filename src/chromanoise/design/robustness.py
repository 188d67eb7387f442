"""Objectives over manufacturing tolerances: the worst of perturbed copies, or a percentile."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.design.parameters import Parameter
from chromanoise.errors import InputError

STATISTICS = ("worst", "percentile-95")
_SHARE = 0.95
_FEWEST_OF_SHARE = 20  # with fewer copies the percentile is the worst
_AT_ONCE = 4096  # candidates


@dataclass(frozen=True, slots=True, kw_only=True)
class ToleranceDraws:
    """How many perturbed copies of a candidate are evaluated, and which statistic counts.

    Attributes
    ----------
    samples
        Copies beside the candidate itself; an even number, as they come in pairs of opposite
        deviations.
    statistic
        ``worst``, or ``percentile-95``: the value that 95 % of the copies reach or surpass.
    seed
        Of the deviations, which are the same for all candidates.

    Raises
    ------
    InputError
        If the number of samples is not positive and even, there is no such statistic, or it needs
        more samples.
    """

    samples: int = 16
    statistic: Literal["worst", "percentile-95"] = "worst"
    seed: int = 1

    def __post_init__(self) -> None:
        statistic = _check.one_of("statistic", self.statistic, STATISTICS)
        object.__setattr__(self, "statistic", statistic)
        if self.samples < 2 or self.samples % 2:
            raise InputError("samples", "must be an even number, at least 2", value=self.samples)
        if self.statistic == "percentile-95" and self.samples < _FEWEST_OF_SHARE:
            raise InputError(
                "samples",
                f"must be at least {_FEWEST_OF_SHARE} for statistic = 'percentile-95'",
                value=self.samples,
            )


def over_tolerances(
    costs: Callable[[Array], Float[Array, "m c"]],
    values: Float[Array, "m d"],
    parameters: Sequence[Parameter],
    draws: ToleranceDraws,
) -> Float[Array, "m c"]:
    """The costs of candidates whose parameters deviate within their tolerances.

    Each copy deviates in all parameters at once, uniformly within plus or minus
    ``Parameter.tolerance``, but never beyond what is physically possible. The statistic is taken
    per cost.

    Parameters
    ----------
    costs
        From values (m d) to numbers (m c) of which higher ones are worse. Each row depends on its
        own values only.
    values
        One row of parameters per candidate.
    parameters
        With their tolerances.
    draws
        Number of copies and statistic.

    Raises
    ------
    InputError
        As `refuse_exact`.
    """
    refuse_exact(parameters)
    width = np.array([one.tolerance for one in parameters])
    moved = np.vstack([np.zeros(width.size), width * _deviations(width.size, draws)])
    least = np.array([one.least for one in parameters])
    most = np.array([one.most for one in parameters])
    many = max(1, _AT_ONCE // len(moved))
    parts = []
    for first in range(0, len(values), many):
        around = values[first : first + many, None] + moved
        # the candidate itself may not lie between the two
        each = np.where(moved == 0, around, np.clip(around, least, most)).reshape(-1, width.size)
        found = costs(each)
        ordered = np.sort(found.reshape(-1, len(moved), found.shape[1]), axis=1)
        parts.append(ordered[:, _place(draws)])
    return np.concatenate(parts)


def refuse_exact(parameters: Sequence[Parameter]) -> None:
    """Refuse parameters of which none has a tolerance.

    Raises
    ------
    InputError
        If there is none.
    """
    if not any(one.tolerance for one in parameters):
        raise InputError(
            "robust",
            "needs the tolerance of at least one parameter",
            found="no parameter has one",
            remedy="give it as {low = 600, high = 900, tolerance = 5}",
        )


def _place(draws: ToleranceDraws) -> int:
    """Index of the cost that counts among those of a candidate and its copies, in rising order."""
    share = 1.0 if draws.statistic == "worst" else _SHARE
    return int(np.ceil(share * draws.samples))


@lru_cache(maxsize=16)
def _deviations(d: int, draws: ToleranceDraws) -> Float[Array, "s d"]:
    """Sobol points in -1 to 1, each followed by its opposite."""
    from scipy.stats import qmc

    half = draws.samples // 2
    sampler = qmc.Sobol(d, seed=np.random.default_rng(draws.seed))
    drawn = 2 * sampler.random(1 << (half - 1).bit_length())[:half] - 1
    return np.stack([drawn, -drawn], axis=1).reshape(-1, d)
