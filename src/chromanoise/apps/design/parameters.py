"""Free numbers of a design with bounds, ties and tolerances, and arrays of many candidates.

The arrays are what a batched evaluation reads of the sensors, with the noise of their pixels.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, fields
from functools import cache, lru_cache
from types import MappingProxyType, SimpleNamespace
from typing import Annotated, Any, Literal, get_args

import numpy as np

from chromanoise.base import (
    Array,
    Before,
    Field,
    Float,
    Inexact,
    InputError,
    Property,
    after,
    check,
    dataclass,
    did_you_mean,
    known_name,
)
from chromanoise.sensor import PIXEL, Sensor, Term, possible, quantization_step_e, sources_of
from chromanoise.study import Part


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidates:
    """``m`` sensors with ``p`` channels on one grid, with their exposure, pixel and matrix.

    All arrays may be complex, for derivatives by the complex step.

    Attributes
    ----------
    qe
        Electrons per photon, filters and crosstalk before counting included. [e-/photon]
    time_s
        Exposure time of each; ``None`` where all have that of the scene. [s]
    pixel_share
        Share of the pixels of the mosaic that each channel has; each row has the sum 1. The
        variance of channel i is divided by ``p * pixel_share[i]``. ``None``: equal shares, as in
        the paper. [1]
    noise_weight
        Weight of the noise in the color matrix: 0 least squares, 1 LMMSE; ``None`` where the matrix
        of the scene decides. [1]
    pixel
        Noise of the pixel of each, by names of ``noise_properties``, as the fields of `Pixel`; what
        is omitted is that of the scene.

    Raises
    ------
    InputError
        If the pixel has no noise of such a name.
    """

    qe: Inexact[Array, "m n p"]
    time_s: Inexact[Array, " m"] | None = None
    pixel_share: Inexact[Array, "m p"] | None = None
    noise_weight: Inexact[Array, " m"] | None = None
    pixel: Mapping[str, Inexact[Array, " m"]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        refuse_other_noise(self.pixel)

    def __len__(self) -> int:
        return len(self.qe)

    def some(self, which: Any) -> "Candidates":
        """Some of the candidates.

        Parameters
        ----------
        which
            An index of numpy.
        """
        given = {name: getattr(self, name) for name in _ARRAYS}
        some: dict[str, Any] = {k: None if v is None else v[which] for k, v in given.items()}
        return Candidates(**some, pixel={name: v[which] for name, v in self.pixel.items()})

    @property
    def dtype(self) -> np.dtype:
        """Complex if an array is, otherwise float64."""
        arrays = [*(getattr(self, name) for name in _ARRAYS), *self.pixel.values()]
        return np.result_type(np.float64, *(one for one in arrays if one is not None))


_ARRAYS = ("qe", "time_s", "pixel_share", "noise_weight")


@cache
def noise_properties() -> Mapping[str, Property]:
    """The properties of a pixel that change the variance of a reading, and of which 0 is none.

    By name, in the order of `Pixel`. Each can be a number of a design.
    """
    return MappingProxyType({name: one for name, one in PIXEL.items() if one.least == 0.0})


def refuse_other_noise(names: Iterable[str]) -> None:
    """Refuse a name that is none of ``noise_properties``.

    Raises
    ------
    InputError
        If there is one.
    """
    for name in names:
        check.one_of("number of the pixel", name, tuple(noise_properties()))


def noise_of(
    sensor: Sensor, time_s: Inexact[Array, " m"], pixel: Mapping[str, Inexact[Array, " m"]]
) -> Inexact[Array, "4 m"]:
    """The law of the variance of each candidate, and its dark electrons.

    Parameters
    ----------
    sensor
        Its converter, and the noise of its pixel that ``pixel`` does not have.
    time_s
        Exposure time of each candidate. [s]
    pixel
        Noise of the pixel of each candidate, by name.

    Returns
    -------
    Array
        ``floor_e2``, ``slope_e`` and ``square`` of `chromanoise.sensor.VarianceLaw`, and the mean
        number of dark electrons [e-]: complex where an argument is.
    """
    own = {one.name: getattr(sensor.pixel, one.name) for one in fields(sensor.pixel)}
    known = SimpleNamespace(**own | dict(pixel), temperature_k=sensor.pixel.temperature_k)
    dark_e = known.dark_current_e_per_s * sensor.pixel.temperature_factor * time_s
    step_e = quantization_step_e(sensor.converter, sensor.pixel)
    of: Any = SimpleNamespace(pixel=known, dark_e=dark_e, step_e=step_e)  # arrays for numbers
    sources = sources_of(sensor.pixel)
    law = (sum(one.value(of) for one in sources if one.term == term) for term in get_args(Term))
    return np.array(np.broadcast_arrays(*law, dark_e))


@dataclass(frozen=True, kw_only=True)
class Free:
    """A number that the search chooses, as a design gives it.

    Attributes
    ----------
    low, high
        Bounds, in the unit of the parameter.
    start
        Where a search with a warm start begins, or ``None``.
    tolerance
        Half width of the manufacturing spread, in the unit of the parameter.
    """

    low: float
    high: float
    start: float | None = None
    tolerance: float = 0.0


Value = float | Free | str
"""A fixed number, a free one, or the name of the parameter to which it is tied."""


@dataclass(frozen=True, kw_only=True)
class Parameter(Free):
    """One free number of a design space: one coordinate of a search.

    Attributes
    ----------
    name
        Part and number, as ``R.center_nm``.
    unit
        Unit of all its values; ``1`` for a ratio.
    low, high
        Bounds of the search.
    start
        Where a search with a warm start begins, or ``None``.
    tolerance
        Half width of the manufacturing spread.
    least, most
        Physical limits; deviations by the tolerance stay within them.
    choices
        Names between which it chooses; then its value is the index of one, rounded to the nearest.

    Raises
    ------
    InputError
        If a number is not finite, the bounds are not in order or not possible, the start is outside
        the bounds, or the tolerance is negative.

    Examples
    --------
    >>> Parameter(name="R.center_nm", unit="nm", low=560.0, high=680.0).span
    120.0
    """

    name: str
    unit: str
    least: float = -math.inf
    most: float = math.inf
    choices: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        low = float(check.finite(f"lower bound of {self.name}", self.unit, self.low))
        high = float(check.finite(f"upper bound of {self.name}", self.unit, self.high))
        if not low < high:
            raise InputError(
                f"bounds of {self.name}",
                f"must satisfy low < high{check.in_brackets(self.unit)}",
                value=(low, high),
                found=f"are {low:g} and {high:g}",
                remedy="give one number to fix it, or exchange the bounds",
            )
        for bound in (low, high):
            self.refuse_impossible(bound)
        if self.start is not None:
            check.within(f"start of {self.name}", self.unit, self.start, low, high)
        check.not_negative(f"tolerance of {self.name}", self.unit, self.tolerance)

    @property
    def span(self) -> float:
        """Distance of the bounds, in the unit of the parameter."""
        return self.high - self.low

    def refuse_impossible(self, value: float) -> None:
        """Refuse a value that is not physically possible.

        Parameters
        ----------
        value
            Value in the unit of the parameter.

        Raises
        ------
        InputError
            If the value is outside `least` to `most`.
        """
        refuse_outside(self.name, self.unit, value, self.least, self.most)


def bounds_of(parameters: Sequence[Free]) -> tuple[Float[Array, " d"], Float[Array, " d"]]:
    """The lower and the upper bounds of parameters, each in its unit."""
    return np.array([one.low for one in parameters]), np.array([one.high for one in parameters])


def refuse_outside(name: str, unit: str, value: float, least: float, most: float) -> None:
    """Refuse a value that is not finite, or not physically possible.

    Raises
    ------
    InputError
        If it is.
    """
    if not least <= value <= most or not math.isfinite(value):
        remedy = "divide percent by 100" if most == 1 and 1 < value <= 100 else ()
        demand = f"must be {possible(least, most)}{check.in_brackets(unit)}"
        raise InputError(name, demand, value=value, remedy=remedy)


def tied_to(name: str, values: Mapping[str, Value]) -> str:
    """The name at the end of a chain of ties: the number that ``name`` takes.

    Parameters
    ----------
    name
        The name of a number of the design.
    values
        All numbers of the design by name.

    Raises
    ------
    InputError
        If a tie leads to a number that the design does not have, or in a circle.

    Examples
    --------
    >>> tied_to("G.width_nm", {"R.width_nm": Free(low=20, high=80), "G.width_nm": "R.width_nm"})
    'R.width_nm'
    """
    chain = [name]
    while isinstance(target := values[chain[-1]], str):
        target = known_name(target, values)
        if target in chain:
            raise InputError(
                chain[-1],
                "must be tied to another parameter",
                value=target,
                found=f"is tied in a circle: {' = '.join((*chain, target))}",
                remedy="give one of them a number or bounds",
            )
        if target not in values:
            raise InputError(
                chain[-1],
                "must be tied to a parameter of the design",
                value=target,
                remedy=did_you_mean(target, list(values), f"known: {', '.join(values)}"),
            )
        chain.append(target)
    return chain[-1]


STATISTICS = ("worst", "percentile-95")
_SHARE = 0.95
_FEWEST_OF_SHARE = 20  # with fewer copies the percentile is the worst
_AT_ONCE = 4096  # candidates


class RobustPart(Part):
    """Draws within the tolerances of the parameters, over which the search takes the objectives."""

    samples: Annotated[int, Field(ge=2, le=4096)] = Field(
        16, description="Perturbed copies of each candidate, an even number."
    )
    statistic: Annotated[
        Literal["worst", "percentile-95"],
        Before(lambda word: known_name(str(word), STATISTICS)),
    ] = Field("worst", description=f"What of the copies counts: {', '.join(STATISTICS)}.")
    seed: Annotated[int, Field(ge=0, lt=2**32)] = Field(1, description="Seed of the deviations.")

    @after
    def _possible(self) -> "RobustPart":
        if self.samples % 2:  # they come in pairs of opposite deviations
            raise InputError("samples", "must be an even number, at least 2", value=self.samples)
        if self.statistic == "percentile-95" and self.samples < _FEWEST_OF_SHARE:
            raise InputError(
                "samples",
                f"must be at least {_FEWEST_OF_SHARE} for statistic = 'percentile-95'",
                value=self.samples,
            )
        return self


def over_tolerances(
    costs: Callable[[Array], Float[Array, "m c"]],
    values: Float[Array, "m d"],
    parameters: Sequence[Parameter],
    draws: RobustPart,
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


def _place(draws: RobustPart) -> int:
    """Index of the cost that counts among those of a candidate and its copies, in rising order."""
    share = 1.0 if draws.statistic == "worst" else _SHARE
    return int(np.ceil(share * draws.samples))


@lru_cache(maxsize=16)
def _deviations(d: int, draws: RobustPart) -> Float[Array, "s d"]:
    """Sobol points in -1 to 1, each followed by its opposite."""
    from scipy.stats import qmc

    half = draws.samples // 2
    sampler = qmc.Sobol(d, seed=np.random.default_rng(draws.seed))
    drawn = 2 * sampler.random(1 << (half - 1).bit_length())[:half] - 1
    return np.stack([drawn, -drawn], axis=1).reshape(-1, d)
