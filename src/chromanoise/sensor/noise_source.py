"""The noise sources of a pixel: add a source to `SOURCES`, and its property to `Pixel`.

Outside of this package, add both to a subclass of `Pixel`, the source in its ``own_noise``.
"""

import math
from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass, fields
from typing import Any, Literal, get_args

from chromanoise import _check
from chromanoise._check import Array
from chromanoise._shapes import Inexact
from chromanoise.errors import InputError
from chromanoise.sensor.pixel import Pixel

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


@dataclass(frozen=True, slots=True, kw_only=True)
class NoiseSource:
    """One source of noise. Table, budget, exact distribution and all draws walk `sources_of`.

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


@dataclass(frozen=True, slots=True, kw_only=True)
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
        Sources that are left out: `FIXED` for the temporal noise.

    Raises
    ------
    InputError
        If a number is negative or not finite, or as `sources_of`.
    """

    pixel: Pixel
    dark_e: float = 0.0
    step_e: float = 0.0
    without: frozenset[Drawn] = frozenset()

    def __post_init__(self) -> None:
        for name in ("dark_e", "step_e"):
            object.__setattr__(self, name, _check.not_negative(name, "e-", getattr(self, name)))
        for one in self.sources[len(SOURCES) :]:
            try:
                value = float(one.value(self))
            except Exception as error:  # of a function that the user wrote
                raise InputError(
                    f"value of {one.cause}",
                    "must return a number for a reading",
                    found=f"raised {type(error).__name__}: {error}",
                ) from error
            _check.not_negative(f"coefficient of {one.cause}", one.term, value)

    @property
    def sources(self) -> tuple[NoiseSource, ...]:
        """The sources of the pixel, in the order of tables and budgets."""
        return sources_of(self.pixel)

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
            if one.term == term and one.drawn in drawn and one.drawn not in (*but, *self.without)
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
            if one.drawn == "levels" and "levels" not in self.without and one.value(self):
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
        _check.one_of(f"drawn of {one.cause}", one.drawn, (*NORMAL, "gain"))
        term = "square" if one.drawn == "gain" else "floor_e2"
        _check.one_of(f"term of {one.cause}", one.term, (term,))
    found = (*SOURCES, *pixel.own_noise)
    _check.distinct("causes of noise", [one.cause for one in found])
    for one in fields(pixel):
        if one.name not in _OF_PIXEL and one.default != 0:
            raise InputError(
                one.name, "must have the default 0, which is no noise", value=one.default
            )
    return found


_OF_PIXEL = frozenset(one.name for one in fields(Pixel))
