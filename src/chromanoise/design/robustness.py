"""Objectives over manufacturing tolerances: the worst of perturbed copies, or a percentile."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Float
from chromanoise.design.evaluation import Evaluator, Space
from chromanoise.errors import InputError

STATISTICS = ("worst", "percentile-95")
_AT_ONCE = 4096  # candidates


@dataclass(frozen=True, slots=True, kw_only=True)
class Tolerances:
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
        If the number of samples is not positive and even, or there is no such statistic.
    """

    samples: int = 16
    statistic: Literal["worst", "percentile-95"] = "worst"
    seed: int = 1

    def __post_init__(self) -> None:
        _check.one_of("statistic of tolerances", self.statistic, STATISTICS)
        if self.samples < 2 or self.samples % 2:
            raise InputError(
                "samples of tolerances", "must be an even number, at least 2", value=self.samples
            )


def robust_values(
    evaluator: Evaluator, space: Space, values: Float[Array, "m d"], tolerances: Tolerances
) -> Float[Array, "m q"]:
    """The objectives of candidates whose parameters deviate within their tolerances.

    Each copy deviates in all parameters at once, uniformly within plus or minus
    ``Parameter.tolerance``, but never beyond what is physically possible. The statistic is taken
    per objective.

    Parameters
    ----------
    evaluator
        Scenes and objectives.
    space
        The design space, whose parameters have tolerances.
    values
        One row of parameters per candidate.
    tolerances
        Number of copies and statistic.

    Raises
    ------
    InputError
        If no parameter has a tolerance, or as `Evaluator.values`.
    """
    width = np.array([one.tolerance for one in space.parameters])
    if not width.any():
        raise InputError(
            "tolerances", "must be given for at least one parameter", found="are all 0"
        )
    moved = np.vstack([np.zeros(width.size), width * _deviations(width.size, tolerances)])
    least, most = (
        np.array([getattr(p, end) for p in space.parameters]) for end in ("least", "most")
    )
    copies = len(moved)
    many = max(1, _AT_ONCE // copies)
    parts = []
    for first in range(0, len(values), many):
        around = values[first : first + many, None] + moved
        # the candidate itself may not lie between the two
        each = np.where(moved == 0, around, np.clip(around, least, most)).reshape(-1, width.size)
        found = evaluator.values(space.candidates(each))
        parts.append(_statistic(evaluator, found.reshape(-1, copies, found.shape[1]), tolerances))
    return np.concatenate(parts)


def _statistic(
    evaluator: Evaluator, values: Float[Array, "m s q"], tolerances: Tolerances
) -> Float[Array, "m q"]:
    higher = np.array([one.better == "higher" for one in evaluator.entries])
    ordered = np.sort(np.where(higher, -values, values), axis=1)  # the last is the worst
    last = ordered.shape[1] - 1
    place = last if tolerances.statistic == "worst" else int(np.ceil(0.95 * last))
    return np.where(higher, -ordered[:, place], ordered[:, place])


@lru_cache(maxsize=16)
def _deviations(d: int, tolerances: Tolerances) -> Float[Array, "s d"]:
    """Sobol points in -1 to 1, each followed by its opposite."""
    from scipy.stats import qmc

    half = tolerances.samples // 2
    sampler = qmc.Sobol(d, seed=np.random.default_rng(tolerances.seed))
    drawn = 2 * sampler.random(1 << (half - 1).bit_length())[:half] - 1
    return np.stack([drawn, -drawn], axis=1).reshape(-1, d)
