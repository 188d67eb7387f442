"""The schema of a study: its records, its keys with their interfaces, and the commented starter.

The classes define which studies are valid. File names are relative to the folder of the study file.
`STARTER` is the commented study that `chromanoise init` writes.
"""

import os
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import reduce
from importlib import resources
from pathlib import Path
from types import MappingProxyType, UnionType
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Literal,
    TypeVar,
    Union,
    get_args,
    get_origin,
)

from chromanoise.base import (
    After,
    Before,
    DeclaredField,
    Field,
    InputError,
    Interface,
    Property,
    Record,
    Setting,
    after,
    beside_their_needs,
    check,
    dataclass,
    did_you_mean,
    known_name,
    no_place_for,
    refusal,
    subclass,
)
from chromanoise.color import SPACES, TONES
from chromanoise.imaging import DEMOSAICING, FORMATS, MOST_FRAMES
from chromanoise.imaging.denoising import DENOISING
from chromanoise.io import MATRIX_ENDINGS, is_matrix_file
from chromanoise.io.spectra import Level, Negatives, Per, Scale, Unit
from chromanoise.noise import DEFAULT_F_NUMBER, DEFAULT_RULE, DEFAULT_SHARE, refuse_f_number
from chromanoise.sensor import (
    MOSAIC_NAMES,
    MOST_BINNING,
    MOST_SHIFT_NM,
    PIXEL,
    PIXEL_NOISE,
    BinningMode,
)
from chromanoise.spectra import (
    BUILTIN_CUBES,
    DEFAULT_OBSERVER,
    METRICS,
    OBSERVERS,
    Beyond,
    Illuminant,
)
from chromanoise.study.camera_pipeline import BASE_ISO, PipelineSettings
from chromanoise.study.color_matrices import (
    DEFAULT_METHOD,
    DEFAULT_PRIOR,
    METHODS,
    PRIORS,
    matrix_makers,
    trained_names,
)
from chromanoise.study.resolve_names import is_file_word, is_object_word, is_reflectance_file
from chromanoise.study.sweeps import QUANTITIES, SWEEPS

if TYPE_CHECKING:
    from chromanoise.sensor import PartialPixel as _PixelNames
else:
    _PixelNames = object

MOST_SENSORS = 1000
"""Largest number of sensors in a study."""
_LONGEST_LABEL = 60
SCHEMA = 1
"""Version of this schema; an incompatible later schema gets another number."""

KEEP_IDLE = {"keep_idle": True}
"""Context of a validation that accepts settings without effect.

The page keeps them, because they take effect again when another control changes. The record of a
run holds all defaults, which count as given when they are read.
"""


class Known:
    """A check that a word is one of ``names``; an error suggests similar ones.

    Parameters
    ----------
    others
        Whether other words are kept, e.g. files, or a function that checks them.
    """

    def __init__(
        self, names: Collection[str], *, others: bool | Callable[[str, str], str] = False
    ) -> None:
        self._registry, self.others = names, others

    @property
    def names(self) -> tuple[str, ...]:
        """The known names; a method may be registered after the class was made."""
        return tuple(self._registry)

    def checked(self, word: str, place: Any) -> Any:
        """The known name that a word is, or another word."""
        return After(self._known).checked(word, place)

    def _known(self, word: str, place: Any) -> str:
        known = known_name(word, self.names)
        if known in self.names or self.others is True:
            return known
        if self.others:
            return self.others(str(place.name), word)
        return _one_of(str(place.name), word, self.names)


def setting(default: Any, description: str, **interface: Any) -> Any:
    """A field of a part that interfaces offer."""
    return Field(default, description, metadata=(Interface(**interface),))


def _one_of(field: str, word: str, names: Sequence[str]) -> str:
    known = known_name(word, names)
    if known not in names:
        remedy = did_you_mean(word, names, f"known are {', '.join(names)}", most=2, cutoff=0.5)
        raise InputError(field, "must be a known name", value=word, remedy=remedy)
    return known


def _within(unit: str, low: float, high: float) -> After:
    """A check that a number is in the range in which double precision suffices."""

    def checked(value: float, place: Any) -> float:
        return check.within(str(place.name), unit, value, low, high)

    return After(checked)


def _of_a_lens(f_number: float) -> float:
    refuse_f_number(f_number)
    return f_number


def _known_matrix(name: str, place: Any) -> str:
    if is_matrix_file(name) or is_object_word(name):
        return name
    if "/" in name or os.sep in name:
        kinds = ", ".join(MATRIX_ENDINGS)
        raise InputError(
            place.name, f"must be a method, or a file that ends in {kinds}", value=name
        )
    word = name.partition("=")[0].strip()
    name = name.replace(word, _one_of(place.name, word, tuple(METHODS)), 1)
    matrix_makers([name], "quanta")  # checks its parameter
    return name


def _own_prior(field: str, name: str) -> str:
    own = is_reflectance_file(name) or is_object_word(name)
    return name if own else _one_of(field, name, tuple(PRIORS))


def _own_observer(field: str, name: str) -> str:
    own = is_object_word(name) or is_file_word(name, "observer")
    return name if own else _one_of(field, name, tuple(OBSERVERS))


def _is_number(given: Any) -> bool:
    return isinstance(given, int | float) and not isinstance(given, bool)


def _or_text(demand: str, fits: Callable[[Any], bool]) -> Before:
    """A check with one error message; the type alone gives one for each type of its union."""

    def checked(given: Any) -> Any:
        if not isinstance(given, str) and not fits(given):
            raise ValueError(demand)
        return given

    return Before(checked)


def _share_or_text(demand: str) -> Before:
    """As `_or_text`, for a share from 0 to 1."""

    def checked(given: Any, place: Any) -> Any:
        if given is None or isinstance(given, str):
            return given
        if not _is_number(given):
            raise ValueError(demand)
        return check.within(str(place.name), "1", float(given), 0.0, 1.0)

    return Before(checked)


def _is_span(given: Any) -> bool:
    pair = isinstance(given, list | tuple) and len(given) == 2
    return given is None or (pair and all(map(_is_number, given)))


def _is_gains(given: Any) -> bool:
    listed = isinstance(given, list | tuple) and len(given) > 0
    return listed and all(_is_number(one) and 0 < one < float("inf") for one in given)


Positive = Annotated[float, Field(gt=0, finite=True)]
NotNegative = Annotated[float, Field(ge=0, finite=True)]
Finite = Annotated[float, Field(finite=True)]
_Shift = Annotated[float, Field(ge=-MOST_SHIFT_NM, le=MOST_SHIFT_NM)]
BALANCE_WORDS = ("gray", "illuminant")
"""White balances that name no illuminant of their own."""
_NEGATIVES = {
    "description": "Small negative values in files of curves, e.g. from digitizing: refuse them, "
    "or set them to 0.",
    "label": "Small negative values",
}


class Part(Record):
    """A part of a study: immutable, without unknown keys, without conversion between types."""

    heading: ClassVar[str] = ""
    """Over the options of its settings in the help of a command."""
    prefix: ClassVar[str] = ""
    """Before the names of its fields in the keywords of its settings."""
    option: ClassVar[str] = ""
    """The one option that gives all its settings; empty: each has its own."""


class LightPart(Part):
    """The light on the scene."""

    heading = "Light"
    illuminant: str = setting(
        "E",
        "Illuminant: E, A, G173 (daylight to 1050 nm), D65 and other CIE names, halogen, "
        "led-white, 3200K, LED660, A+0.5xLED850 (A plus an 850 nm LED of 0.5 times its power), a "
        "file of one curve (any format of `chromanoise inspect`), or another name of `chromanoise "
        "catalog illuminants`.",
        curves=True,
        common=True,
    )
    level_lux: Annotated[Positive, _within("lx", 1e-15, 1e15)] = setting(
        10.0, "Illuminance [lx].", keyword="lux", common=True
    )
    beyond: Beyond = setting(
        "refuse",
        "Illuminant outside the wavelengths of its curve: refuse, zero, or hold (the value at the "
        "end). CIE tables end at 780 nm or before (D60 at 830 nm); E and A have no limit.",
        keyword="illuminant_beyond",
    )
    per: Per | None = setting(
        None,
        "Whether the illuminant's file gives photons or energy (power), if it does not declare it.",
        keyword="illuminant_per",
        flags=(("photon", "--illuminant-photons"), ("energy", "--illuminant-energy")),
        label="Illuminant file in",
    )
    column: str | None = setting(
        None,
        "Name of the illuminant's curve in its file.",
        keyword="illuminant_column",
        label="Column of the file",
    )
    wavelength_unit: Unit | None = setting(
        None,
        "Unit of the wavelengths in the illuminant's file, where it does not declare it.",
        keyword="illuminant_wavelength_unit",
        label="Unit of the wavelengths",
    )
    negatives: Negatives = setting("refuse", **_NEGATIVES)


SomePart = TypeVar("SomePart", bound=Part)


def _with_properties(
    properties: Mapping[str, Property], default: str = ".", **interface: Any
) -> Callable[[type[SomePart]], type[SomePart]]:
    """A decorator that adds properties, each of which may be given, after the fields of a part."""
    added: dict[str, Any] = {
        name: (
            Annotated[float, one] | None,
            setting(
                None,
                one.help.removesuffix(".") + default,
                **{
                    "label": one.label[:1].upper() + one.label[1:],
                    "slider": one.slider,
                    "logarithmic": one.logarithmic and bool(one.slider and one.slider[0] > 0),
                    "needs": one.needs,
                    "later": one.later,
                    "common": one.common,
                    **interface,
                },
            ),
        )
        for name, one in properties.items()
    }

    def extended(part: type[SomePart]) -> type[SomePart]:
        return subclass(part, part.__name__, added, __doc__=part.__doc__)

    return extended


@_with_properties(beside_their_needs(PIXEL))
class _FileAndPixelPart(Part, _PixelNames):
    heading = "Pixel"
    file: str | None = setting(
        None,
        "EMVA 1288 data sheet, DNG noise profile or photon transfer table: the pixel of all "
        "sensors. Values that are not in the file are the sensor's own; values that are set "
        "separately override the file.",
        keyword="pixel",
        metavar="FILE",
        paths=True,
        label="File of the pixel",
        hint="none",
        file="pixel",
    )


class PixelPart(_FileAndPixelPart):
    """Changes to the sensor's pixel."""

    bits: Annotated[int, Field(ge=8, le=16)] | None = setting(
        None,
        "Bits of the converter; its step adds quantization noise.",
        label="Bits of the converter",
        slider=(8, 16, 1),
        hint="none",
    )
    gain_dn_per_e: Annotated[Positive, _within("DN/e-", 1e-15, 1e12)] | None = setting(
        None,
        "Gain K of the converter [DN/e-]; default with bits: full well at the top code; without "
        "bits nothing is quantized.",
        label="Gain K",
        slider=(0.001, 100.0, 0.02),
        logarithmic=True,
        hint="from bits",
    )
    binning: Annotated[int, Field(ge=1, le=MOST_BINNING)] | None = setting(
        None,
        "Pixels of one channel that are summed, e.g. 4 for 2 x 2; the other values stay those of "
        "one pixel.",
        metavar="N",
        label="Binned pixels",
        slider=(1, 16, 1),
    )
    binning_mode: BinningMode | None = setting(
        None,
        "charge: the sum is read once (default). digital: each pixel is read, and the readings are "
        "summed.",
        needs=("binning",),
    )

    @after
    def _mode_of_binning(self) -> "PixelPart":
        if self.binning_mode is not None and self.binning in (None, 1):
            raise InputError(
                "binning_mode",
                "must be given only with binning of 2 pixels or more",
                value=self.binning_mode,
                found="there is none" if self.binning is None else "binning is 1",
                remedy=(Setting("binning"), Setting("binning_mode", omit=True)),
            )
        return self


class AnswersPart(Part):
    """Metadata that a file of QE curves lacks."""

    heading = "Files of curves"
    scale: Scale | None = setting(
        None,
        "Whether the QE values are percent or fractions.",
        keyword="qe_scale",
        flags=(("percent", "--percent"), ("fraction", "--fraction")),
        label="QE values are",
    )
    level: Level | None = setting(
        None,
        "Whether the curves are relative or absolute.",
        flags=(("relative", "--relative"), ("absolute", "--absolute")),
        label="Curves are",
    )
    per: Per | None = setting(
        None,
        "Whether the curves are responses per photon (QE) or per energy (e.g. A/W).",
        flags=(("photon", "--photons"), ("energy", "--energy")),
        label="Response per",
    )
    wavelength_unit: Unit | None = setting(
        None,
        "Unit of the wavelengths, where the file does not declare it.",
        label="Unit of the wavelengths",
    )
    peak_qe: Annotated[float, Field(gt=0, le=1)] | None = setting(
        None,
        "Highest QE of all channels [e-/photon], to which relative curves are scaled.",
        label="Peak QE of relative curves",
        slider=(0.05, 1.0, 0.01),
    )


def _printable(text: str, place: Any) -> str:
    """A check that a text can be shown in one line of a table."""
    if not text.isprintable() or not text.strip():
        raise InputError(
            place.name, "must be one line with visible characters", value=text, found=None
        )
    return text


class ReflectancesPart(Part):
    """The reflectances that replace the ColorChecker and the perfect white."""

    heading = "Reflectances"
    chart: str | None = setting(
        None,
        "File of reflectances for color error, noise per patch and total error instead of the "
        "ColorChecker (any format of `chromanoise inspect`).",
        keyword="chart_file",
        metavar="FILE",
        curves=True,
        hint="the ColorChecker",
        file="spectrum",
    )
    patch: Annotated[
        float | str | None, _share_or_text("must be a number from 0 to 1, a name or a file")
    ] = setting(
        None,
        "The patch that is analyzed instead of a perfect white: a number, e.g. 0.18, a patch of "
        "the ColorChecker (dark skin) or of the catalog (lawn), or a curve of a file.",
        metavar="NUMBER|NAME|FILE[:NAME]",
        curves=True,
        hint="perfect white; e.g. 0.18",
        file="spectrum",
    )
    pairs: str | None = setting(
        None,
        "Pairs of patches that a machine must tell apart: a CSV file with the header "
        "first,second and two patches of the ColorChecker or of the catalog per line, or a file of "
        "reflectances, all of whose pairs are taken; default: all pairs of the chart.",
        metavar="FILE",
        curves=True,
        label="Pairs for a machine",
        hint="all pairs",
        file="spectrum",
    )
    scale: Scale | None = setting(
        None,
        "Whether the files of reflectances are percent or fractions.",
        keyword="reflectance_scale",
        label="Reflectances are",
    )
    wavelength_unit: Unit | None = setting(
        None,
        "Unit of the wavelengths in files of reflectances without one.",
        keyword="reflectance_wavelength_unit",
        label="Unit of the wavelengths",
    )
    beyond: Beyond | None = setting(
        None,
        "Values outside the range of the curves of reflectances, also of the prior: refuse, zero "
        "or hold; default: that of the first sensor.",
        keyword="reflectance_beyond",
        label="Outside the range of the curves",
    )


_BEFORE = "none; e.g. ircut-650"


class SensorPart(Part):
    """One sensor."""

    heading = "Sensor"
    name: str = Field(
        description="Name of the catalog, or a file of QE curves, relative to the study's folder."
    )
    label: Annotated[str, Field(max_length=_LONGEST_LABEL), After(_printable)] | None = setting(
        None,
        "Text in place of the name of a sensor in tables and charts; one per sensor, in their "
        "order.",
        keyword="labels",
        option="label",
        each=True,
        hint="its name",
    )
    beyond: Beyond = setting(
        "refuse",
        "Curves outside the wavelengths of their file, where it does not cover 400-1050 nm: "
        "refuse, zero, or hold (the value at the end).",
        label="Outside the range of the curves",
    )
    answers: AnswersPart = Field(AnswersPart(), description="Metadata that its file lacks.")
    pixel: PixelPart = Field(PixelPart(), description="Changes to its pixel.")
    filter: str | None = setting(
        None,
        "Filter on the sensor: ircut-650, ircut-650/20, ircut-schott, another name of `chromanoise "
        "catalog filters`, or a file of one transmittance (any format of `chromanoise inspect`).",
        metavar="NAME|FILE",
        curves=True,
        common=True,
        label="Filter on the sensor",
        hint=_BEFORE,
        file="spectrum",
    )
    channel_filters: dict[str, str] | None = setting(
        None,
        "Filter of a single channel: a name or a file of one transmittance, e.g. ircut-650 for R.",
        option="channel-filter",
        metavar="CHANNEL=NAME|FILE",
        curves=True,
        label="Filter of channel",
        hint=_BEFORE,
        file="spectrum",
    )
    filter_wavelength_unit: Unit | None = setting(
        None,
        "Unit of the wavelengths in the filter's file, where it does not declare it.",
        label="Unit of the filter's wavelengths",
        needs=("filter",),
    )
    shift_ircut_nm: _Shift = setting(
        0.0,
        "Shift of the filter in wavelength, positive toward red [nm].",
        label="Shift of the filter on the sensor",
        slider=(-50.0, 50.0, 1.0),
        needs=("filter",),
        later=True,
    )
    negatives: Negatives = setting("refuse", **_NEGATIVES)
    crosstalk: Annotated[
        float | str | None, _share_or_text("must be a share from 0 to 1, or the name of a file")
    ] = setting(
        None,
        "Share of its light that a pixel loses to its four neighbors, a quarter to each (needs a "
        "mosaic), or a file: a table with one row and column per channel, or a kernel of "
        "neighbors.",
        metavar="SHARE|FILE",
        paths=True,
        label="Crosstalk to the neighbors",
        slider=(0.0, 0.5, 0.01),
        file="crosstalk",
    )
    crosstalk_stage: Literal["light", "charge"] = setting(
        "light",
        "Crosstalk before counting (light), or after it (charge: interpixel capacitance, which "
        "correlates the readings).",
        needs=("crosstalk",),
    )
    mosaic: Annotated[str, Known(MOSAIC_NAMES, others=True)] | None = setting(
        None,
        "Mosaic of the sensor, for crosstalk, figures of merit and pictures: "
        f"{', '.join(MOSAIC_NAMES)}, or rows, e.g. RG/GB or 'Red Yellow; Yellow Blue'; default: "
        "that of the sensor.",
        metavar="NAME|ROWS",
        hint="its own; e.g. bayer, RG/GB",
    )
    ircut_nm: Annotated[float, Field(ge=450, le=2000)] | None = setting(
        None,
        "Wavelength of half transmittance of an added model IR-cut [nm].",
        label="IR-cut edge",
        slider=(600.0, 1050.0, 5.0),
    )
    shift_nm: _Shift = setting(
        0.0,
        "Shift of all QE curves in wavelength, positive toward red [nm].",
        label="Shift of the QE curves",
        slider=(-50.0, 50.0, 1.0),
    )


class ExposurePart(Part):
    """Exposure time, lens, and the rule by which the sensors are compared."""

    heading = "Exposure"
    equal: Literal["exposure", "saturation", "light"] = setting(
        DEFAULT_RULE,
        "What is equal for all sensors. exposure: the time. saturation: the share of full well, "
        "each with its own time. light: time x pixel area x pixels per set of channels, so with "
        "equal pixels a 4-channel mosaic has 3/4 of the time of a 3-channel one.",
    )
    time_ms: Annotated[Positive, _within("ms", 1e-12, 1e15)] | None = setting(
        None,
        "Exposure time [ms], the same for all sensors; default: auto exposure, from the share of "
        "full well.",
        common=True,
    )
    saturate: Annotated[float, Field(gt=0, le=1), _within("of full well", 1e-9, 1.0)] = setting(
        DEFAULT_SHARE,
        "Share of full well that the most sensitive channel reaches on a perfect white with auto "
        "exposure.",
    )
    f_number: Annotated[Positive, After(_of_a_lens)] = setting(
        DEFAULT_F_NUMBER, "f-number of the lens.", common=True
    )
    magnification: Finite | None = setting(
        None,
        "Magnification m of the lens [1], with the camera equation 1/(1 + 4 f#^2 (1 + |m|)^2); "
        "default: the paper's distant scene, 1/(4 f#^2).",
        label="Magnification of the lens",
        slider=(-1.0, 0.0, 0.01),
        hint="distant scene",
    )

    @after
    def _one_rule(self, place: Any) -> "ExposurePart":
        if _shares_time(self) and not _keeps(place):
            raise no_place_for(
                "time_ms",
                "must not be given with a share of full well, from which the time is solved",
                self.time_ms,
                *(Setting("time_ms", omit=True), Setting("saturate", omit=True)),
            )
        if self.time_ms is not None and self.equal != "exposure":
            raise InputError(
                "equal",
                "must be 'exposure' where a time is given, which all sensors share",
                value=self.equal,
                remedy=(Setting("time_ms", omit=True), Setting("equal", omit=True)),
            )
        return self


def _shares_time(rule: ExposurePart) -> bool:
    """Whether both a time and the share of full well are given, from which it would be solved."""
    return rule.time_ms is not None and "saturate" in rule.model_fields_set


_MOST_VALUES = 1_000_000


class SecondSweepPart(Part):
    """A second parameter of a sweep: the quantity on a grid of pairs of values."""

    heading = "Sweep"
    prefix = "second_"
    option = "and"
    vary: Annotated[str, Known(SWEEPS)] = setting(
        ..., "Second parameter that varies; the names are those of the sweep.", part="NAME"
    )
    first: Finite = setting(..., "Lowest value of the second parameter, in its unit.", part="FIRST")
    last: Finite = setting(..., "Highest value of the second parameter.", part="LAST")
    points: Annotated[int, Field(ge=2, le=100_000)] = setting(
        21, "Number of values of the second parameter.", part="POINTS"
    )


class SweepPart(Part):
    """One parameter that varies, or two, and the quantity to compute."""

    heading = "Sweep"
    vary: Annotated[str, Known(SWEEPS)] = setting(
        ..., f"Parameter that varies: {', '.join(SWEEPS)}.", option="sweep", part="NAME"
    )
    first: Finite = setting(
        ..., "Lowest value, in the unit of the sweep.", option="sweep", part="FIRST"
    )
    last: Finite = setting(..., "Highest value.", option="sweep", part="LAST")
    points: Annotated[int, Field(ge=2, le=100_000)] = setting(61, "Number of values of the sweep.")
    quantity: Annotated[str, Known(QUANTITIES)] = setting(
        "snr-y", f"Quantity to compare: {', '.join(QUANTITIES)}.", common=True
    )
    all_priors: bool = setting(
        False, "Also the range of each crossover over all priors.", option="prior", part="all"
    )
    second: SecondSweepPart | None = Field(
        None, description="A second parameter that varies: values on a grid, and a heat map."
    )

    @after
    def _of_two_parameters(self) -> "SweepPart":
        if self.second is None:
            return self
        if self.second.vary == self.vary:
            remedies = ("vary another thing", Setting("second.vary", omit=True))
            demand = "must differ from the second parameter of the sweep"
            raise no_place_for("vary", demand, self.vary, *remedies)
        if self.all_priors:
            demand = "must not be given with a second parameter"
            raise no_place_for("all_priors", demand, True, "omit one of them")
        count = self.points * self.second.points
        if count > _MOST_VALUES:
            raise InputError(
                "points",
                f"must give at most {_MOST_VALUES} pairs of values with a second parameter",
                value=count,
                found=f"gives {count}",
            )
        return self


@_with_properties(
    {name: PIXEL[name] for name in PIXEL_NOISE},
    "; default: from the file of the pixel, else 0.",
    keyword=None,
    needs=(),
)
class PicturePart(Part):
    """Pictures of one cube with every sensor, as `chromanoise simulate` renders them."""

    heading = "Picture"
    cube: Annotated[str, Known(BUILTIN_CUBES, others=True)] = Field(
        "builtin:checker", description=f"{', '.join(BUILTIN_CUBES)}, or a file."
    )
    key: str | None = setting(None, "Name of the array in a MAT, NPZ, HDF5, NetCDF or Zarr cube.")
    shape: tuple[int, int] | None = setting(
        None, "Rows and columns of a cube stored as a 2-D array.", metavar="ROWSxCOLUMNS"
    )
    wavelengths: Annotated[
        tuple[float, float] | str | None,
        _or_text(
            "must be [FIRST, LAST] in nm, or the name of a file that lists them all", _is_span
        ),
    ] = setting(
        None,
        "If the cube does not declare them: first and last band [nm], evenly spaced, or a text "
        "file that lists one wavelength per band.",
        metavar="FIRST:LAST|FILE",
    )
    scale: Positive | None = setting(
        None,
        "Reflectance per stored unit of the cube, e.g. 0.0001.",
        label="Reflectance per stored unit",
        slider=(1e-5, 10.0),
        logarithmic=True,
    )
    beyond: Beyond = setting(
        "refuse",
        "Reflectances outside the wavelengths of the cube, and curves of sensors outside those of "
        "their files: refuse, zero, or hold (the value at the end).",
    )
    bad_pixels: Literal["refuse", "zero"] = setting(
        "refuse",
        "Values that are no reflectance (NaN, negative, above 2): refuse them, or use 0.",
        label="Invalid reflectances",
    )
    mosaic: Annotated[str, Known(MOSAIC_NAMES, others=True)] | None = setting(
        None,
        f"Raw codes of one channel per pixel: sensor (its own), {', '.join(MOSAIC_NAMES)}, or "
        "rows, e.g. RG/GB or 'R G/IR B'. Without it all channels are at every pixel, as in the "
        "paper.",
        metavar="NAME|ROWS",
        common=True,
    )
    demosaic: Annotated[str, Known(DEMOSAICING)] | None = setting(
        None,
        f"Demosaicing method: {', '.join(DEMOSAICING)}; gradient and lmmse are trained on the "
        "ColorChecker; default with a mosaic: bilinear.",
    )
    raw_only: bool = setting(False, "Only the raw codes of the mosaic, without color.")
    bits: Annotated[int, Field(ge=8, le=16)] | None = setting(
        None,
        "Bits of the converter, 8 to 16, with a mosaic; default: from the file of the pixel, else "
        "12.",
    )
    black_level: Annotated[int, Field(ge=0, lt=2**16)] | None = setting(
        None, "Code without light, with a mosaic; default: from the file of the pixel, else 0."
    )
    frames: Annotated[int, Field(ge=1, le=MOST_FRAMES)] = setting(
        1, "Number of frames of a burst, each with new temporal noise and the same fixed pattern."
    )
    denoise: Annotated[str, Known(DENOISING)] | None = setting(
        None,
        "Denoising of the electrons with their known noise, before the color matrix: "
        f"{', '.join(DENOISING)}; raw codes are not denoised; default: no denoising.",
        common=True,
    )
    formats: Annotated[tuple[Annotated[str, Known(FORMATS)], ...], Field(min_length=1)] | None = (
        setting(
            None,
            f"File formats: {', '.join(FORMATS)}; default: png and xyz, or raw and dng of a "
            "mosaic.",
            option="format",
            metavar="NAME[,NAME...]",
            common=True,
        )
    )
    clip: bool = setting(
        False,
        "Clip electrons between 0 and full well.",
        label="Clip electrons in the picture",
    )

    @after
    def _of_a_mosaic(self) -> "PicturePart":
        given = {name: getattr(self, name) for name in _OF_MOSAIC}
        demand = "must not be given without a mosaic"
        idle = [
            no_place_for(name, demand, value, Setting("mosaic"))
            for name, value in given.items()
            if value is not None and value is not False
        ]
        if self.mosaic is None and idle:
            raise refusal(idle)
        if self.mosaic is not None and self.clip:
            demand = "must not be given with a mosaic, whose converter clips anyway"
            raise no_place_for("clip", demand, self.clip, "omit one of them")
        for name in ("demosaic", "denoise"):
            value = getattr(self, name)
            if self.raw_only and value is not None:
                demand = "must not be given where only raw codes are asked for"
                raise no_place_for(name, demand, value, "omit one of them")
        return self


_OF_MOSAIC = ("demosaic", "raw_only", "bits", "black_level")


class ParetoPart(Part):
    """Curve of color error against noise, for a range of weights of the noise."""

    heading = "Color"
    prefix = "pareto_"
    option = "pareto"
    first: Positive = setting(
        ...,
        "Lowest weight of the noise; 1 is LMMSE, and weights near 0 approach least squares.",
        part="FIRST",
    )
    last: Positive = setting(..., "Highest weight of the noise.", part="LAST")
    points: Annotated[int, Field(ge=2, le=100_000)] = setting(
        13, "Number of weights.", part="POINTS"
    )


class PipelinePart(Part):
    """The camera's own pipeline: noise of the ColorChecker after each of its steps."""

    heading = "Pipeline of the camera"
    run: bool = setting(
        False,
        "Noise of each ColorChecker patch after each step of the camera's own pipeline: raw, "
        "white-balanced, XYZ, linear sRGB, exposure, saturation, tone, Y'CbCr, Lab; at each ISO "
        "also dynamic range and noise profile.",
        keyword="pipeline",
        label="Noise after each step",
    )
    white_balance: Annotated[
        tuple[Positive, ...] | str,
        _or_text(
            "must be gray, illuminant, the name of an illuminant, or finite gains > 0, one per "
            "channel",
            _is_gains,
        ),
    ] = setting(
        BALANCE_WORDS[0],
        "White balance of the pipeline. gray: equal raw values of an 18 % gray as it is read. "
        "illuminant, or the name or file of another one: equal raw values of a white under it. Or "
        "one gain per channel.",
        metavar="gray|illuminant|NAME|R,G,B...",
        curves=True,
        suggestions=(*BALANCE_WORDS, "D65"),
        hint="gray, D65, or gains",
    )
    white_balance_pixels: Annotated[int, Field(ge=1, le=10**9)] | None = setting(
        None,
        "Number of gray pixels per channel from which the gains are estimated, whose noise is "
        "added; only with white balance gray; default: exact gains.",
        label="Gray pixels for the gains",
        slider=(10, 10**6, 0.1),
        logarithmic=True,
        hint="exact",
    )
    exposure_gain: Positive = setting(
        1.0, "Gain of linear RGB.", slider=(0.1, 10.0, 0.02), logarithmic=True
    )
    saturation: NotNegative = setting(
        1.0,
        "Saturation of linear RGB around Rec. 709 luma; 0 is gray, 1 changes nothing.",
        label="Color saturation",
        slider=(0.0, 2.0),
    )
    tone: Annotated[
        float | str, _or_text(f"must be {', '.join(TONES)}, or a gamma", _is_number)
    ] = setting(
        "srgb",
        f"Tone curve: {', '.join(TONES)}, or the gamma of a power law, e.g. 2.2.",
        metavar=f"{'|'.join(TONES)}|GAMMA",
        label="Tone curve",
        suggestions=(*TONES, "2.2"),
    )
    luma: Literal["bt709", "bt601"] = setting("bt709", "Luma weights of Y'CbCr.")
    iso: Annotated[tuple[Positive, ...], Field(min_length=1, max_length=100)] = setting(
        (BASE_ISO,),
        "ISO settings, e.g. 100,400,1600; gain and exposure are those of the base ISO times "
        "and divided by the same factor.",
        metavar="LIST",
        label="ISO settings",
        hint="e.g. 100, 200, 400",
    )
    base_iso: Positive = setting(
        BASE_ISO,
        "ISO of the sensor as it is given.",
        label="Base ISO",
        slider=(10.0, 3200.0),
        logarithmic=True,
    )
    iso_read_noise_e: tuple[NotNegative, ...] | None = setting(
        None,
        "Read noise at each ISO [e-], one value per ISO setting; default: that of the sensor.",
        metavar="LIST",
        label="Read noise at each ISO",
        hint="the same",
    )

    @after
    def _that_has_an_effect(self, place: Any) -> "PipelinePart":
        pipeline_settings(self)
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            given = name in self.model_fields_set - {"run"} and not _keeps(place)
            if not self.run and (given or value != field.default):
                demand = "must be given only with the pipeline"
                raise no_place_for(name, demand, value, Setting("run", (True,)), "omit it")
        return self


def pipeline_settings(part: PipelinePart, light: Illuminant | None = None) -> PipelineSettings:
    """The settings of a pipeline.

    Parameters
    ----------
    light
        The illuminant that ``white_balance`` names; ``None`` only checks the other values.

    Raises
    ------
    InputError
        As `PipelineSettings`.
    """
    balance: str | Illuminant | tuple[float, ...] = part.white_balance
    if isinstance(balance, str) and balance != "gray":
        balance = light or (1.0,)
    given = {name: getattr(part, name) for name in PipelinePart.model_fields if name != "run"}
    return PipelineSettings(**given | {"white_balance": balance})


class OutputsPart(Part):
    """The outputs of a run."""

    heading = "Results"
    analyses: bool = setting(
        True,
        "Signal and noise of each sensor at every stage (raw, spectral, color), for each matrix.",
        keyword=None,
        label="Every stage, per matrix",
    )
    clip: bool = setting(
        False,
        "Exact mean and variance of electrons clipped between 0 and full well, instead of eq. 7; "
        "not with budget or merit.",
        label="Clip electrons (not with budget or merit)",
    )
    budget: bool = setting(
        True,
        "SNR loss per cause [dB]: X, Y, Z, contravariant, L*, a*, b*.",
        common=True,
        label="SNR budget",
    )
    merit: bool = setting(
        False,
        "Figures of merit: Neugebauer, Vora, SMI, SNR10, ISO speed, visual noise, bits ...",
        common=True,
        label="Figures of merit",
    )
    chart: bool = setting(
        False,
        "Color error and noise of each patch of the chart, by default the ColorChecker.",
        label="Every patch of the chart",
    )
    space: Annotated[str, Known(SPACES)] | None = setting(
        None, "Noise of an 18 % gray in this color space.", label="Color space of the gray's noise"
    )
    reader: Literal["eye", "machine"] = setting(
        "eye",
        "Who judges. eye: by color and its noise. machine: by the distance of patches in raw "
        "values, in units of their noise.",
        common=True,
    )
    matrix: bool = setting(
        False,
        "The color matrices, with color error and noise.",
        keyword=None,
        label="Color matrices: error and noise",
    )
    pipeline: PipelinePart = Field(
        PipelinePart(), description="The camera's own pipeline, from raw to Y'CbCr and Lab."
    )
    pareto: ParetoPart | None = Field(
        None, description="With matrix: the curve of color error against noise."
    )

    @after
    def _that_go_together(self) -> "OutputsPart":
        unclipped = [name for name in ("budget", "merit") if getattr(self, name)]
        if self.clip and unclipped:
            others = [Setting(name, (False,)) for name in unclipped if len(unclipped) == 1]
            demand = f"must not be given with {' or '.join(unclipped)}: eq. 7 has no clipping"
            raise no_place_for("clip", demand, self.clip, Setting("clip", omit=True), *others)
        if self.pareto is not None and not self.matrix:
            raise InputError(
                "pareto", "must be given with the matrix", remedy=Setting("matrix", (True,))
            )
        return self


class Study(Part):
    """One reproducible run; file names are relative to the folder of the study file.

    Its parameters are its fields, each with a description; `study_schema` lists them. `read_study`
    and `study_from_data` build a study and raise `InputError` instead.

    Raises
    ------
    RecordError
        If a field is missing, unknown or invalid, or a setting has no effect.
    """

    heading = "Color"
    schema_number: Annotated[int, Field(ge=SCHEMA, le=SCHEMA)] = Field(
        SCHEMA, alias="schema", description=f"Version of this format: {SCHEMA}."
    )
    title: str = setting("", "Title of the study.", keyword=None)
    metric: Annotated[str, Known(METRICS)] = setting(
        "quanta",
        "Whether spectra are expressed in photons (quanta) or in energy.",
        label="Spectra in",
    )
    observer: Annotated[str, Known(OBSERVERS, others=_own_observer)] = setting(
        DEFAULT_OBSERVER,
        f"Observer of the colors: {', '.join(OBSERVERS)}, or a file of color-matching functions x, "
        "y, z; illuminance is always that of CIE 1931.",
        metavar="NAME|FILE",
        curves=True,
        label="Observer",
        file="spectrum",
    )
    seed: Annotated[int, Field(ge=0, lt=2**32)] = setting(
        0,
        "Seed of all random noise; sensors with different names have independent noise.",
        label="Seed of the noise",
        heading="Picture",
        slider=(0, 99, 1),
    )
    light: LightPart = Field(LightPart(), description="The light on the scene.")
    exposure: ExposurePart = Field(ExposurePart(), description="Exposure time and lens.")
    sensors: Annotated[
        tuple[SensorPart, ...],
        Field(min_length=1, max_length=MOST_SENSORS, description="One or more."),
    ]
    matrices: Annotated[
        tuple[Annotated[str, After(_known_matrix)], ...],
        Field(min_length=1),
    ] = Field(
        (DEFAULT_METHOD,),
        description=f"Color matrices: {', '.join(METHODS)}; ridge=0.01; or files.",
    )
    prior: Annotated[str, Known(PRIORS, others=_own_prior)] = setting(
        DEFAULT_PRIOR,
        f"Training set of trained matrices: {', '.join(PRIORS)}; or a file of reflectances.",
        metavar="NAME|FILE",
        curves=True,
        label="Prior of trained matrices",
        file="spectrum",
    )
    reflectances: ReflectancesPart = Field(
        ReflectancesPart(), description="Own reflectances as chart and as patch."
    )
    sweeps: Annotated[
        tuple[SweepPart, ...],
        Field(
            description="Sweeps, computed one after the other.",
        ),
    ] = ()
    pictures: Annotated[
        tuple[PicturePart, ...],
        Field(
            description="Pictures of cubes with every sensor.",
        ),
    ] = ()
    outputs: OutputsPart = Field(OutputsPart(), description="Outputs of the run.")

    @after
    def _without_idle_settings(self, place: Any) -> "Study":
        errors = [] if _keeps(place) else [*_idle_priors(self), *_replaced_settings(self)]
        if errors:
            raise refusal(errors)
        return self


StudyKind = TypeVar("StudyKind", bound=Study)
"""A study, or a document that has the tables of a study and others."""


def _keeps(place: Any) -> bool:
    return bool(place.context.get("keep_idle"))


def _idle_priors(study: Study) -> Iterator[InputError]:
    """A prior that is given although no matrix is trained on it."""
    if trained_names(study.matrices):
        return
    names = ", ".join(name.strip() for name in study.matrices)
    found = f"{'the matrix is' if len(study.matrices) == 1 else 'none is among'} {names}"
    requirement = "must be given only with a trained matrix, as lmmse"
    if "prior" in study.model_fields_set and study.outputs.pareto is None:
        yield InputError(
            "prior", requirement, value=study.prior, found=found, remedy="omit it", setting="prior"
        )
    for i, sweep in enumerate(study.sweeps):
        if sweep.all_priors:
            key = f"sweeps.{i}.all_priors"
            yield InputError(
                "all_priors", requirement, value=True, found=found, remedy="omit it", setting=key
            )


def _replaced_settings(study: Study) -> Iterator[InputError]:
    """A setting that is given although every step of the study replaces it by other values."""
    others = study.outputs.analyses or study.outputs.matrix or study.pictures
    sweeps = [(one.vary, *((one.second.vary,) if one.second else ())) for one in study.sweeps]
    replaced = [{SWEEPS[name].replaces for name in names} for names in sweeps]
    if others or not replaced:
        return
    keys = [
        key.replace("*", str(i))
        for key in sorted(set.intersection(*replaced) - {""})
        for i in (range(len(study.sensors)) if "*" in key else [0])
    ]
    for one in keys:
        value = value_at(study, one)
        if value is not None:
            name, demand = one.rpartition(".")[2], "must not be given where it varies"
            remedy = "omit it, or vary another thing"
            yield no_place_for(name, demand, value, remedy, setting=one)


def value_at(of: Any, key: str) -> Any:
    """The value of a key in a study or in its plain data; ``None`` where it has no such value.

    Parameters
    ----------
    of
        A study, a part of one, or plain data.
    key
        With dots between its steps; ``*`` is the first entry of a list.

    Examples
    --------
    >>> value_at({"sensors": [{"name": "onyx-rgbw"}]}, "sensors.*.name")
    'onyx-rgbw'
    """
    for step in key.replace("*", "0").split("."):
        if isinstance(of, list | tuple):
            of = of[int(step)] if int(step) < len(of) else None
        else:
            of = of.get(step) if isinstance(of, Mapping) else getattr(of, step, None)
    return of


def without_idle_settings(study: Study) -> Study:
    """A study that was checked with `KEEP_IDLE`, without the settings that have no effect.

    Examples
    --------
    >>> data = {"sensors": [{"name": "onyx-rgbw"}], "prior": "chart"}
    >>> without_idle_settings(Study.model_validate(data, context=KEEP_IDLE)).prior
    'chart-nir'
    """
    keys = [one.setting for one in (*_idle_priors(study), *_replaced_settings(study))]
    keys += ["exposure.saturate"] if _shares_time(study.exposure) else []
    if not keys:
        return study
    data = study.model_dump(by_alias=True, exclude_defaults=True)
    for key in keys:
        part, _, name = key.rpartition(".")
        (value_at(data, part) if part else data).pop(name, None)
    return Study.model_validate(data)


def study_schema() -> dict[str, Any]:
    """The JSON Schema of a study file, for editors and other programs."""
    return Study.model_json_schema() | {"$schema": "https://json-schema.org/draft/2020-12/schema"}


@dataclass(frozen=True, kw_only=True)
class KeyOfStudy:
    """A key of a study that holds a value.

    Attributes
    ----------
    key
        With ``*`` for a sensor and ``0`` for an entry of another list: ``sensors.*.pixel.dsnu_e``.
    field
        Its type, default and description.
    interface
        How interfaces offer it; ``None`` for a key of study files alone.
    part
        The part of a study that it is in.
    """

    key: str
    field: DeclaredField
    interface: Interface | None
    part: type[Record]

    @property
    def heading(self) -> str:
        """Over its option in the help of a command."""
        own = self.interface.heading if self.interface is not None else ""
        return own or str(getattr(self.part, "heading", ""))

    @property
    def keyword(self) -> str | None:
        """Its flat name as a setting; ``None`` if it is none."""
        if self.interface is None or self.interface.keyword is None:
            return None
        return self.interface.keyword or self.key.rpartition(".")[2]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of which its word is one; other words may be possible too."""
        found = [one for one in _inside(self) if isinstance(one, Known)]
        return found[0].names if found else ()

    @property
    def others(self) -> bool:
        """Whether it takes other words than `names`."""
        return any(one.others for one in _inside(self) if isinstance(one, Known))

    @property
    def type(self) -> Any:
        """Type of its value in Python, without ``None``."""
        if self.interface is not None and self.interface.each:
            return Sequence[str]
        return _of_python(self.field.annotation, self.interface or Interface())


def _inside(one: KeyOfStudy) -> list[Any]:
    """The metadata and the types of a field, also those inside a union."""
    return [*one.field.metadata, *_parts_of(one.field.annotation)]


def _parts_of(annotation: Any) -> list[Any]:
    """A type with all types and metadata inside it."""
    return [annotation, *(part for one in get_args(annotation) for part in _parts_of(one))]


_MAPPING: Any = Mapping  # types of values, which type checkers do not follow
_SEQUENCE: Any = Sequence
_TUPLE: Any = tuple


def _of_python(annotation: Any, interface: Interface) -> Any:
    origin, inside = get_origin(annotation), get_args(annotation)
    if origin is Annotated:
        return _of_python(inside[0], interface)
    if origin in (Union, UnionType):
        kinds = [_of_python(one, interface) for one in inside if one is not type(None)]
        return reduce(lambda a, b: a | b, kinds)
    if origin is dict:
        return _MAPPING[str, _of_python(inside[1], interface)]
    if origin is tuple:
        ends = [_of_python(one, Interface()) for one in inside if one is not ...]
        return _SEQUENCE[ends[0]] if ... in inside else _TUPLE[*ends]
    if annotation is str and interface.curves:
        return str | Path | object
    return str | Path if annotation is str and interface.paths else annotation


def _walked(model: type[Record], prefix: str) -> Iterator[KeyOfStudy]:
    for name, field in model.model_fields.items():
        key = f"{prefix}{field.alias or name}"
        inside = _parts_of(field.annotation)
        part = next((p for p in inside if isinstance(p, type) and issubclass(p, Record)), None)
        if part is not None:
            many = any(get_origin(p) is tuple for p in inside)
            index = ("*." if name == "sensors" else "0.") if many else ""
            yield from _walked(part, f"{key}.{index}")
            continue
        interface = next((one for one in field.metadata if isinstance(one, Interface)), None)
        if interface is not None and issubclass(model, Part) and model.prefix:
            interface = replace(interface, keyword=f"{model.prefix}{name}", option=model.option)
        yield KeyOfStudy(key=key, field=field, interface=interface, part=model)


KEYS: Mapping[str, KeyOfStudy] = MappingProxyType({one.key: one for one in _walked(Study, "")})
"""The keys of a study that hold values, in the order of its classes."""


STARTER = resources.files("chromanoise.study").joinpath("starter.toml").read_text(encoding="utf-8")
"""The commented study file that ``chromanoise init`` writes."""
