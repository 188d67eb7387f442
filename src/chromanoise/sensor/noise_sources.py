"""The noise sources of a pixel, the variance of a reading, and models of read noise.

Add a source to `SOURCES`, and its property to `Pixel`. Outside of this package, add both to a
subclass of `Pixel`, the source in its ``own_noise``.

The variance of a reading is floor + slope m + square m^2 at m expected electrons. Three laws give
the read noise over the gain: ELD's straight line of logarithms, noise before and after the gain, a
measured table.
"""

import math
from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import fields
from typing import Any, Literal, get_args

import numpy as np

from chromanoise.base import Array, Bool, Float, Inexact, InputError, Int, check, dataclass
from chromanoise.sensor.pixel import Pixel

_UNITS = {"floor_e2": "e-^2", "slope_e": "e-", "square": "1"}


@dataclass(frozen=True, kw_only=True, eq=False)
class VarianceLaw:
    """Variance of one reading, or of the readings of several planes, as a law of the light.

    Attributes
    ----------
    floor_e2
        Variance without light: readout, dark electrons, rounding. [e-^2]
    slope_e
        Variance per electron of light; 1 for shot noise of electrons. [e-]
    square
        Variance per squared electron of light: PRNU^2. [1]

    Raises
    ------
    InputError
        If a coefficient is negative or not finite, or the numbers of planes differ.

    Notes
    -----
    EMVA 1288, release 4.0: the linear camera model with the non-uniformity of the response.

    Examples
    --------
    >>> law = VarianceLaw(floor_e2=16.0, slope_e=1.0) + VarianceLaw(square=0.01**2)
    >>> law.variance_e2(np.array([0.0, 1000.0]))
    array([  16., 1116.])
    """

    floor_e2: float | Float[Array, " p"] = 0.0
    slope_e: float | Float[Array, " p"] = 0.0
    square: float | Float[Array, " p"] = 0.0

    def __post_init__(self) -> None:
        for name, unit in _UNITS.items():
            check.non_negative(name, unit, getattr(self, name))
        arrays = [name for name in _UNITS if np.ndim(getattr(self, name))]
        check.same_length("planes", **{name: np.size(getattr(self, name)) for name in arrays})
        check.freeze(self, *arrays)

    def variance_e2(self, mean_e: float | Float[Array, "*px"]) -> Float[Array, "*px"]:
        """Variance at these means, one law for all or one per entry of the last axis. [e-^2]

        Parameters
        ----------
        mean_e
            Expected electrons of the light. [e-]
        """
        mean = np.asarray(mean_e, dtype=np.float64)
        return np.asarray(self.floor_e2 + (self.slope_e + self.square * mean) * mean)

    @property
    def coefficients(self) -> Float[Array, "3 *p"]:
        """Floor, slope and square, a row each; a column per plane."""
        rows = np.broadcast_arrays(self.floor_e2, self.slope_e, self.square)
        return np.stack(rows).astype(np.float64)

    @property
    def has_noise(self) -> Bool[Array, "*p"]:
        """Whether the readings have noise at some mean."""
        return np.asarray((self.coefficients > 0).any(axis=0))

    def of_planes(self, count: int) -> "VarianceLaw":
        """The law with arrays: one law for all planes becomes one for each.

        Parameters
        ----------
        count
            Number of planes of the result.

        Raises
        ------
        InputError
            If the law is that of another number of planes.
        """
        rows = self.coefficients
        if rows.ndim == 1:
            return _law(np.tile(rows[:, None], count))
        check.same_length("planes", **{"given": count, "variance law": rows.shape[1]})
        return _law(rows)

    def take(
        self, planes: int | Sequence[int] | Int[Array, " n"] | Bool[Array, " p"]
    ) -> "VarianceLaw":
        """The law of one or some of the planes.

        Parameters
        ----------
        planes
            Index, indices, which may repeat, or a flag for each plane.
        """
        return _law(self.coefficients[:, np.asarray(planes)])

    def scaled(self, share: float | Float[Array, " p"]) -> "VarianceLaw":
        """The law of a variance that is this one times ``share``, at the same mean.

        Parameters
        ----------
        share
            Such as 1/4 for the mean of four readings, or the square of a weight. [1]
        """
        return _law(self.coefficients * share)

    def in_units_of(self, unit_e: float | Float[Array, " p"]) -> "VarianceLaw":
        """The law of the readings divided by ``unit_e``, of their mean divided by it.

        Parameters
        ----------
        unit_e
            Such as the electrons from black to white: the floor is then O and the slope S of the
            noise profile of DNG. [e-]

        Examples
        --------
        >>> law = VarianceLaw(floor_e2=16.0, slope_e=1.0, square=0.25).in_units_of(4.0)
        >>> law.coefficients
        array([1.  , 0.25, 0.25])
        """
        floor, slope, square = self.coefficients
        return _law(np.stack(np.broadcast_arrays(floor / unit_e**2, slope / unit_e, square)))

    def __add__(self, other: "VarianceLaw") -> "VarianceLaw":
        """The law of two independent sources together."""
        return VarianceLaw(**{name: getattr(self, name) + getattr(other, name) for name in _UNITS})

    def __sub__(self, part: "VarianceLaw") -> "VarianceLaw":
        """The law without one of its independent sources; refused if that one is larger."""
        rest = {name: getattr(self, name) - getattr(part, name) for name in _UNITS}
        for name, unit in _UNITS.items():
            check.non_negative(f"{name} without that of a part", unit, rest[name])
        return VarianceLaw(**rest)


def _law(coefficients: Float[Array, "3 *p"]) -> VarianceLaw:
    floor, slope, square = coefficients
    return VarianceLaw(floor_e2=floor, slope_e=slope, square=square)


NoiseKind = Literal["total", "temporal"]
"""All noise of one reading over a flat field, or only what changes from frame to frame."""

PATTERN = "crosstalk pattern"
BOLTZMANN_J_PER_K, CHARGE_C = 1.380649e-23, 1.602176634e-19

Drawn = Literal[
    "count", "reading", "levels", "row", "column", "rounding", "pattern", "gain", "place"
]
"""How a source is drawn.

``count``: electrons that are counted (Poisson). Normal and new in every frame: ``reading`` of each
pixel, ``row`` and ``column`` for all pixels of a row or column. ``levels``: some pixels read one of
two levels, each in half of the frames. ``rounding``: to codes. The same in every frame: an offset
of each pixel (``pattern``), its sensitivity (``gain``), its ``place`` in the mosaic.
"""
Term = Literal["floor_e2", "slope_e", "square"]
"""A coefficient of `chromanoise.sensor.VarianceLaw`."""
ALL = frozenset[Drawn](get_args(Drawn))
FIXED = frozenset[Drawn]({"pattern", "gain", "place"})
"""What is the same in every frame: spatial noise."""
NORMAL: tuple[Drawn, ...] = ("reading", "row", "pattern", "column")
"""Normal offsets."""
READ_OUT = frozenset[Drawn]({"reading", "levels", "row", "column", "rounding", "place"})
"""What the readout adds after the electrons are counted, so that crosstalk does not mix it."""


@dataclass(frozen=True, kw_only=True)
class NoiseSource:
    """One source of noise. Table, budget, exact distribution and all draws walk ``sources_of``.

    Attributes
    ----------
    cause
        Its name in tables and budgets.
    drawn
        How it is drawn.
    term
        The coefficient of `chromanoise.sensor.VarianceLaw` that it adds to.
    value
        Its part of the coefficient. [e-^2], [e-] or [1]
    share
        Share of the pixels that have it. [1]
    words
        What it is, where the cause does not say it.
    """

    cause: str
    drawn: Drawn
    term: Term
    value: Callable[["PixelReading"], Any]
    share: Callable[["PixelReading"], float] = lambda of: 1.0
    words: str = ""


@dataclass(frozen=True, kw_only=True)
class PixelReading:
    """One reading of a pixel: all that the coefficients of its noise depend on.

    Attributes
    ----------
    pixel
        The pixel, binned or not.
    dark_e
        Mean number of dark electrons; the mean is subtracted, their shot noise stays. [e-]
    step_e
        Electrons per code; 0 where nothing is rounded. [e-]
    without
        Ways of drawing whose sources are left out: `FIXED` for the temporal noise.
    without_causes
        Single sources that are left out.

    Raises
    ------
    InputError
        If a number is negative or not finite, or as `sources_of`.
    """

    pixel: Pixel
    dark_e: float = 0.0
    step_e: float = 0.0
    without: frozenset[Drawn] = frozenset()
    without_causes: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        for name in ("dark_e", "step_e"):
            object.__setattr__(self, name, check.not_negative(name, "e-", getattr(self, name)))
        for one in self.sources[len(SOURCES) :]:
            try:
                value = float(one.value(self))
            except Exception as error:  # of a function that the user wrote
                raise InputError(
                    f"value of {one.cause}",
                    "must return a number for a reading",
                    found=f"raised {type(error).__name__}: {error}",
                ) from error
            check.not_negative(f"coefficient of {one.cause}", one.term, value)

    @property
    def sources(self) -> tuple[NoiseSource, ...]:
        """The sources of the pixel, in the order of tables and budgets."""
        return sources_of(self.pixel)

    def has(self, one: NoiseSource) -> bool:
        """Whether a source is not left out.

        Parameters
        ----------
        one
            One of ``sources``.
        """
        return one.drawn not in self.without and one.cause not in self.without_causes

    def coefficient(self, term: str, drawn: Container[Drawn], but: Iterable[Drawn] = ()) -> float:
        """A coefficient of the law of the variance. [e-^2], [e-] or [1]

        Parameters
        ----------
        term
            As `NoiseSource.term`.
        drawn, but
            The sources that count: drawn in one of these ways, but not in those.
        """
        return sum(
            one.value(self)
            for one in self.sources
            if one.term == term and one.drawn in drawn and one.drawn not in but and self.has(one)
        )

    def sd(self, drawn: Drawn) -> float:
        """Standard deviation of all sources that are drawn in one way. [e-], of gain [1]

        Parameters
        ----------
        drawn
            How the sources are drawn.
        """
        return math.sqrt(self.coefficient("square" if drawn == "gain" else "floor_e2", (drawn,)))

    @property
    def levels(self) -> tuple[float, float]:
        """Share of the pixels with two levels [1], and half the difference of the two. [e-]"""
        for one in self.sources:
            if one.drawn == "levels" and self.has(one) and one.value(self):
                share = one.share(self)
                return share, math.sqrt(one.value(self) / share)
        return 0.0, 0.0


def reset_noise_e2(
    capacitance_ff: float | Inexact[Array, " m"], temperature_k: float
) -> float | Inexact[Array, " m"]:
    """Variance of the electrons that a reset leaves on a capacitance. [e-^2]

    Parameters
    ----------
    capacitance_ff
        Capacitance of the node. [fF]
    temperature_k
        Temperature of the node. [K]

    Notes
    -----
    k T C / q^2: equipartition, Nyquist (Phys. Rev. 32, 1928); constants of the SI, 2019.

    Examples
    --------
    >>> round(math.sqrt(reset_noise_e2(19.2, 293.15)), 3)
    55.021
    """
    return BOLTZMANN_J_PER_K * temperature_k * capacitance_ff * 1e-15 / CHARGE_C**2


SOURCES = (
    NoiseSource(cause="shot noise", drawn="count", term="slope_e", value=lambda of: 1.0),
    NoiseSource(
        cause="read noise", drawn="reading", term="floor_e2",
        value=lambda of: of.pixel.read_noise_e**2,
    ),
    NoiseSource(
        cause="dark current", drawn="count", term="floor_e2", value=lambda of: of.dark_e,
        words="its shot noise",
    ),
    NoiseSource(
        cause="quantization", drawn="rounding", term="floor_e2",
        value=lambda of: of.step_e**2 / 12,
    ),
    NoiseSource(
        cause="row noise", drawn="row", term="floor_e2", value=lambda of: of.pixel.row_noise_e**2
    ),
    NoiseSource(
        cause="column noise", drawn="column", term="floor_e2",
        value=lambda of: of.pixel.column_noise_e**2,
    ),
    NoiseSource(
        cause="reset noise", drawn="reading", term="floor_e2",
        value=lambda of: reset_noise_e2(of.pixel.reset_capacitance_ff, of.pixel.temperature_k),
        words="kTC of the sense node",
    ),
    NoiseSource(
        cause="telegraph noise", drawn="levels", term="floor_e2",
        value=lambda of: of.pixel.rtn_share * (of.pixel.rtn_amplitude_e / 2) ** 2,
        share=lambda of: of.pixel.rtn_share,
        words="pixels that switch between two levels",
    ),
    NoiseSource(
        cause="DSNU", drawn="pattern", term="floor_e2", value=lambda of: of.pixel.dsnu_e**2,
        words="fixed pattern in the dark",
    ),
    NoiseSource(
        cause="PRNU", drawn="gain", term="square", value=lambda of: of.pixel.prnu**2,
        words="fixed pattern",
    ),
    NoiseSource(
        cause=PATTERN, drawn="place", term="square", value=lambda of: 0.0,
        words="fixed pattern of pixels with different neighbors",
    ),
)  # fmt: skip
"""All sources in the order of tables and budgets.

The law of the crosstalk pattern is `CrosstalkPattern.variance_e2`, of the light of all channels.
"""
SHOT, READ = SOURCES[0].cause, SOURCES[1].cause


def sources_of(pixel: Pixel) -> tuple[NoiseSource, ...]:
    """`SOURCES`, then the ``own_noise`` of the class of a pixel.

    Parameters
    ----------
    pixel
        Of `Pixel` or a subclass.

    Raises
    ------
    InputError
        If two sources have one name, or one is drawn in a way that only `SOURCES` can have.
    """
    if not pixel.own_noise:
        return SOURCES
    for one in pixel.own_noise:
        check.one_of(f"drawn of {one.cause}", one.drawn, (*NORMAL, "gain"))
        term = "square" if one.drawn == "gain" else "floor_e2"
        check.one_of(f"term of {one.cause}", one.term, (term,))
    found = (*SOURCES, *pixel.own_noise)
    check.distinct("causes of noise", [one.cause for one in found])
    for one in fields(pixel):
        if one.name not in _OF_PIXEL and one.default != 0:
            raise InputError(
                one.name, "must have the default 0, which is no noise", value=one.default
            )
    return found


_OF_PIXEL = frozenset(one.name for one in fields(Pixel))


LEAST_LAMBDA, LARGEST_LAMBDA = -0.4, 0.8
"""Shapes of the Tukey lambda distribution that are sampled; its variance ends at -0.5."""

_LEAST_SHARE = 2.0**-33  # of a random word of 32 bits
_LOGISTIC = 1e-5  # shapes below it are taken as 0, the logistic distribution
MOST_E, MOST_DN = 1e9, 2.0**24
"""Largest noise. [e-], [DN]"""


def tukey_lambda_variance(shape: float) -> float:
    """Variance of the Tukey lambda distribution of scale 1, sampled with words of 32 bits. [1]

    Parameters
    ----------
    shape
        lambda: 0.14 is nearly normal, 0 the logistic distribution, below 0 the tails are heavy.

    Returns
    -------
    float
        Of the quantile function Q(u) = (u^lambda - (1 - u)^lambda) / lambda for the shares u from
        2^-33 to 1 - 2^-33, the only ones that a word of 32 bits gives. At lambda = -0.25 it is
        3e-5 below the variance of all shares.

    Raises
    ------
    InputError
        If the shape is not from -0.4 to 0.8.

    Notes
    -----
    Joiner & Rosenblatt, "Some properties of the range in samples from Tukey's symmetric lambda
    distributions", JASA 66 (1971) 394.

    Examples
    --------
    Near 0 it is the variance of the logistic distribution, pi^2 / 3.

    >>> round(tukey_lambda_variance(0.0), 4), round(math.pi**2 / 3, 4)
    (3.2899, 3.2899)
    """
    from scipy.special import beta, betainc

    at = check.within("tail_lambda", "1", shape, LEAST_LAMBDA, LARGEST_LAMBDA)
    if abs(at) < _LOGISTIC:
        return math.pi**2 / 3
    low, high = _LEAST_SHARE, 1 - _LEAST_SHARE
    squares = (high ** (2 * at + 1) - low ** (2 * at + 1)) / (2 * at + 1)
    inside = float(betainc(at + 1, at + 1, high) - betainc(at + 1, at + 1, low))
    products = float(beta(at + 1, at + 1)) * inside
    return 2 * (squares - products) / at**2 / (high - low)


@dataclass(frozen=True, kw_only=True)
class LogLinearNoise:
    """ELD's law of noise against gain: ln(noise) = slope ln(K) + bias + N(0, sigma^2).

    Attributes
    ----------
    slope, bias
        Of the straight line; K in DN/e-, the noise in DN. [1]
    sigma
        Standard deviation of ln(noise) about the line. [1]
    tukey_scale
        Whether the noise is the scale of a Tukey lambda distribution, not a standard deviation.

    Raises
    ------
    InputError
        If a number is not finite, or ``sigma`` is negative.

    Notes
    -----
    Wei, Fu, Yang & Huang, "A physics-based noise formation model for extreme low-light raw
    denoising", CVPR (2020), eq. 11.
    """

    slope: float
    bias: float
    sigma: float = 0.0
    tukey_scale: bool = False

    def __post_init__(self) -> None:
        check.within("slope", "1", self.slope, -100, 100)
        check.within("bias", "1", self.bias, -100, 100)
        check.within("sigma", "1", self.sigma, 0, 100)

    def noise_dn(self, gain_dn_per_e: Float[Array, " p"], *, score: float = 0) -> Array:
        """The noise at a gain. [DN]

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        score
            Deviation of ln(noise) from the line, in units of ``sigma``. [1]

        Returns
        -------
        (p,) array
        """
        return np.exp(self.slope * np.log(gain_dn_per_e) + self.bias + self.sigma * score)


@dataclass(frozen=True, kw_only=True)
class ReadNoiseSum:
    """Read noise before and after the gain: sigma_dn^2 = a + b K^2.

    Attributes
    ----------
    after_gain_dn
        Noise after the amplifier, mostly of the converter: the root of a, >= 0. [DN]
    before_gain_e
        Noise before the amplifier: the root of b, >= 0. [e-]

    Raises
    ------
    InputError
        If a number is negative or not finite.
    """

    after_gain_dn: float
    before_gain_e: float

    def __post_init__(self) -> None:
        check.within("after_gain_dn", "DN", self.after_gain_dn, 0, MOST_DN)
        check.within("before_gain_e", "e-", self.before_gain_e, 0, MOST_E)

    def noise_dn(self, gain_dn_per_e: Float[Array, " p"], *, score: float = 0) -> Array:
        """The read noise at a gain; it does not scatter, so ``score`` is not used. [DN]

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        score
            As `LogLinearNoise.noise_dn`. [1]

        Returns
        -------
        (p,) array

        Examples
        --------
        >>> ReadNoiseSum(after_gain_dn=3.0, before_gain_e=2.0).noise_dn(np.array([2.0]))
        array([5.])
        """
        return np.hypot(self.after_gain_dn, self.before_gain_e * np.asarray(gain_dn_per_e))


def read_noise_sum(
    gain_dn_per_e: Float[Array, " n"], read_noise_dn: Float[Array, " n"]
) -> ReadNoiseSum:
    """The law sigma_dn^2 = a + b K^2 fitted to a table of read noise against gain.

    Parameters
    ----------
    gain_dn_per_e
        Two or more different gains. [DN/e-]
    read_noise_dn
        Read noise at each, > 0. [DN]

    Returns
    -------
    ReadNoiseSum
        The least-squares fit of the relative deviation of the variance, with a and b >= 0.

    Raises
    ------
    InputError
        If the lengths differ, a number is not above 0, or all gains are equal.

    Examples
    --------
    >>> fit = read_noise_sum(np.array([1.0, 2.0, 4.0]), np.sqrt([10.0, 13.0, 25.0]))
    >>> round(fit.after_gain_dn, 6), round(fit.before_gain_e, 6)
    (3.0, 1.0)
    """
    gain = above_zero("gain_dn_per_e", "DN/e-", gain_dn_per_e)
    noise = above_zero("read_noise_dn", "DN", read_noise_dn)
    check.same_length("entries", gain_dn_per_e=gain.size, read_noise_dn=noise.size)
    if len({*gain.tolist()}) < 2:
        raise InputError("gain_dn_per_e", "must have two different gains", value=gain.tolist())
    from scipy.optimize import nnls

    terms = np.stack([1 / noise**2, (gain / noise) ** 2], axis=1)
    scale = terms.max(axis=0)
    a, b = nnls(terms / scale, np.ones(gain.size))[0] / scale  # (a + b gain^2) / noise^2 = 1
    return ReadNoiseSum(after_gain_dn=float(np.sqrt(a)), before_gain_e=float(np.sqrt(b)))


@dataclass(frozen=True, kw_only=True, eq=False)
class ReadNoiseTable:
    """Measured noise of readout against gain, interpolated linearly in ln(noise) and ln(K).

    Attributes
    ----------
    gain_dn_per_e
        Two or more gains, increasing, > 0. [DN/e-]
    read_noise_dn
        Read noise at each gain, > 0. [DN]

    Raises
    ------
    InputError
        If the gains do not increase, a number is not above 0, or the lengths differ.
    """

    gain_dn_per_e: Float[Array, " n"]
    read_noise_dn: Float[Array, " n"]

    def __post_init__(self) -> None:
        gain = check.increasing("gain_dn_per_e", "DN/e-", self.gain_dn_per_e)
        above_zero("gain_dn_per_e", "DN/e-", gain)
        noise = above_zero("read_noise_dn", "DN", self.read_noise_dn)
        check.same_length("entries", gain_dn_per_e=gain.size, read_noise_dn=noise.size)
        check.keep(self, gain_dn_per_e=gain, read_noise_dn=noise)

    def noise_dn(self, gain_dn_per_e: Float[Array, " p"], *, score: float = 0) -> Array:
        """The read noise at a gain; it does not scatter, so ``score`` is not used. [DN]

        Parameters
        ----------
        gain_dn_per_e
            Gain per channel. [DN/e-]
        score
            As `LogLinearNoise.noise_dn`. [1]

        Returns
        -------
        (p,) array

        Raises
        ------
        InputError
            If a gain is outside the table.

        Examples
        --------
        >>> table = ReadNoiseTable(gain_dn_per_e=np.array([1.0, 4.0]),
        ...                        read_noise_dn=np.array([2.0, 8.0]))
        >>> table.noise_dn(np.array([2.0])).round(6)
        array([4.])
        """
        gain = np.asarray(gain_dn_per_e, dtype=np.float64)
        low, high = self.gain_dn_per_e[0], self.gain_dn_per_e[-1]
        outside = (gain < low * (1 - 1e-9)) | (gain > high * (1 + 1e-9))
        if outside.any():
            first = float(gain[outside][0])
            raise InputError(
                "gain_dn_per_e",
                f"must be within the read-noise table, {low:g} to {high:g} [DN/e-]",
                value=first,
                remedy=("take another ISO", "fit the table with read_noise_sum"),
            )
        at = np.interp(np.log(gain), np.log(self.gain_dn_per_e), np.log(self.read_noise_dn))
        return np.exp(at)


ReadNoiseLaw = LogLinearNoise | ReadNoiseSum | ReadNoiseTable
"""How the read noise in DN depends on the gain."""


def above_zero(name: str, unit: str, values: Any) -> Array:
    """One-dimensional finite numbers > 0.

    Raises
    ------
    InputError
        If a number is not finite or not above 0.
    """
    array = np.atleast_1d(check.non_negative(name, unit, values))
    if not (array > 0).all():
        at = int(np.argmin(array))
        raise InputError(
            name, f"must be finite and > 0 [{unit}]", value=float(array[at]), where=f"index ({at},)"
        )
    return array
