"""The schema of a study: light, sensors, exposure rule, matrices, sweeps, pictures, outputs.

The classes define which studies are valid. File names are relative to the folder of the study
file.
"""

import os
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    create_model,
    field_validator,
    model_validator,
)

from chromanoise import _check
from chromanoise.analysis.color_matrices import (
    DEFAULT_METHOD,
    METHODS,
    matrix_makers,
    trained_names,
)
from chromanoise.analysis.comparison.quantities import QUANTITIES
from chromanoise.analysis.comparison.sweeps import SWEEPS
from chromanoise.analysis.pipeline_results import BASE_ISO, PipelineSettings
from chromanoise.analysis.priors import DEFAULT_PRIOR, PRIORS
from chromanoise.catalog.objects import is_object_word
from chromanoise.catalog.reflectances import is_reflectance_file
from chromanoise.catalog.resolve import is_file_word
from chromanoise.color import SPACES, TONES
from chromanoise.denoising import DENOISING
from chromanoise.errors import InputError, Setting, did_you_mean, known_name, refusal
from chromanoise.exposure import refuse_f_number
from chromanoise.imaging import DEMOSAICING
from chromanoise.imaging.formats import FORMATS, MOST_FRAMES
from chromanoise.io.given_matrices import MATRIX_ENDINGS, is_matrix_file
from chromanoise.io.spectra.parsed import Negatives, Unit
from chromanoise.properties import Property, beside_their_needs
from chromanoise.scene import BUILTIN_CUBES
from chromanoise.sensor import (
    MOSAIC_NAMES,
    MOST_BINNING,
    MOST_SHIFT_NM,
    PIXEL,
    PIXEL_NOISE,
    BinningMode,
)
from chromanoise.spectra import DEFAULT_OBSERVER, METRICS, OBSERVERS, Illuminant

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


def _known(names: Iterable[str]) -> AfterValidator:
    """The one of ``names`` that a word is; an error suggests similar names."""

    def checked(word: str, info: Any) -> str:
        return _one_of(info.field_name, word, tuple(names))

    return AfterValidator(checked)


def _spelled_as(names: Iterable[str]) -> AfterValidator:
    """The one of ``names`` that a word is; other words, as files and rows, are kept."""
    return AfterValidator(lambda word: known_name(word, tuple(names)))


def _one_of(field: str, word: str, names: Sequence[str]) -> str:
    known = known_name(word, names)
    if known not in names:
        remedy = did_you_mean(word, names, f"known are {', '.join(names)}", most=2, cutoff=0.5)
        raise InputError(field, "must be a known name", value=word, remedy=remedy)
    return known


def _within(unit: str, low: float, high: float) -> AfterValidator:
    """A check that a number is in the range in which double precision suffices."""

    def checked(value: float, info: Any) -> float:
        return _check.within(str(info.field_name), unit, value, low, high)

    return AfterValidator(checked)


def _of_a_lens(f_number: float) -> float:
    refuse_f_number(f_number)
    return f_number


def _known_matrix(name: str, info: Any) -> str:
    if is_matrix_file(name) or is_object_word(name):
        return name
    if "/" in name or os.sep in name:
        kinds = ", ".join(MATRIX_ENDINGS)
        raise InputError(
            info.field_name, f"must be a method, or a file that ends in {kinds}", value=name
        )
    word = name.partition("=")[0].strip()
    name = name.replace(word, _one_of(info.field_name, word, tuple(METHODS)), 1)
    matrix_makers([name], "quanta")  # checks its parameter
    return name


def _known_prior(name: str, info: Any) -> str:
    own = is_reflectance_file(name) or is_object_word(name)
    return name if own else _one_of(info.field_name, name, tuple(PRIORS))


def _known_observer(name: str, info: Any) -> str:
    own = name in OBSERVERS or is_object_word(name) or is_file_word(name, "observer")
    return name if own else _one_of(info.field_name, name, tuple(OBSERVERS))


Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
_Shift = Annotated[float, Field(ge=-MOST_SHIFT_NM, le=MOST_SHIFT_NM)]
Beyond = Literal["refuse", "zero", "hold"]
BALANCE_WORDS = ("gray", "illuminant")
"""White balances that name no illuminant of their own."""
_NEGATIVES = (
    "Small negative values in the file, e.g. from digitizing: refuse them or set them to 0."
)


class Part(BaseModel):
    """A part of a study: immutable, without unknown keys, without conversion between types.

    Validators are built when the first value is checked, because most commands read no study.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, defer_build=True)

    @classmethod
    def known_keys(cls, given: Mapping[str, Any]) -> Collection[str]:
        """The keys of the part.

        Parameters
        ----------
        given
            Its values by key, not yet checked.
        """
        return [field.alias or name for name, field in cls.model_fields.items()]

    @model_validator(mode="before")
    @classmethod
    def _with_known_keys(cls, given: Any) -> Any:
        """The values by the names of their keys, in which ``_`` and ``-`` are equal."""
        if not isinstance(given, dict) or not all(isinstance(key, str) for key in given):
            return given
        known, found = cls.known_keys(given), dict[str, Any]()
        for key, value in given.items():
            meant = known_name(key, known)
            found[key if meant in found or meant in given else meant] = value
        return found


class LightPart(Part):
    """The light on the scene."""

    illuminant: str = Field(
        "E", description="E, A, G173, D65 ..., 3200K, LED660, A+0.5xLED850, or a file."
    )
    level_lux: Annotated[Positive, _within("lx", 1e-15, 1e15)] = Field(
        10.0, description="Illuminance [lx]."
    )
    beyond: Beyond = Field(
        "refuse",
        description="Values outside the range of the curve: refuse, zero or hold.",
    )
    per: Literal["photon", "energy"] | None = Field(
        None, description="Whether its file counts photons or energy, if it does not declare it."
    )
    column: str | None = Field(None, description="Name of the curve in its file.")
    wavelength_unit: Unit | None = Field(
        None, description="Unit of the wavelengths, where its file does not declare it."
    )
    negatives: Negatives = Field("refuse", description=_NEGATIVES)


SomePart = TypeVar("SomePart", bound=Part)


def _with_properties(
    properties: Mapping[str, Property], default: str = "."
) -> Callable[[type[SomePart]], type[SomePart]]:
    """A decorator that adds properties, each of which may be given, after the fields of a part."""
    added: dict[str, Any] = {
        name: (
            Annotated[float, one] | None,
            Field(None, description=one.help.removesuffix(".") + default),
        )
        for name, one in properties.items()
    }

    def extended(part: type[SomePart]) -> type[SomePart]:
        return create_model(
            part.__name__, __base__=part, __doc__=part.__doc__, __module__=part.__module__, **added
        )

    return extended


@_with_properties(beside_their_needs(PIXEL))
class _FileAndPixelPart(Part, _PixelNames):
    file: str | None = Field(
        None,
        description="EMVA 1288 sheet, DNG noise profile or photon transfer table; the keys "
        "below override it.",
    )


class PixelPart(_FileAndPixelPart):
    """Changes to the sensor's pixel."""

    bits: Annotated[int, Field(ge=8, le=16)] | None = Field(
        None, description="Bits of the converter; its step adds quantization noise."
    )
    gain_dn_per_e: Annotated[Positive, _within("DN/e-", 1e-15, 1e12)] | None = Field(
        None, description="Gain K of the converter [DN/e-]; default: full well at the top code."
    )
    binning: Annotated[int, Field(ge=1, le=MOST_BINNING)] | None = Field(
        None, description="Pixels of one channel that are summed, e.g. 4 for 2 x 2."
    )
    binning_mode: BinningMode | None = Field(
        None,
        description="charge: one reading of the sum (default); digital: as many readings, summed.",
    )

    @model_validator(mode="after")
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

    scale: Literal["percent", "fraction"] | None = Field(
        None, description="Whether the QE values are percent or fractions."
    )
    level: Literal["relative", "absolute"] | None = Field(
        None, description="Whether the curves are relative or absolute."
    )
    per: Literal["photon", "energy"] | None = Field(
        None,
        description="Whether the curves are per photon or per energy.",
    )
    wavelength_unit: Unit | None = Field(
        None, description="Unit of its wavelengths, where the file does not declare it."
    )
    peak_qe: Annotated[float, Field(gt=0, le=1)] | None = Field(
        None, description="Highest QE of relative curves [e-/photon]."
    )


def _printable(text: str, info: Any) -> str:
    """A check that a text can be shown in one line of a table."""
    if not text.isprintable() or not text.strip():
        raise InputError(
            info.field_name, "must be one line with visible characters", value=text, found=None
        )
    return text


class ReflectancesPart(Part):
    """The reflectances that replace the ColorChecker and the perfect white."""

    chart: str | None = Field(
        None,
        description="File of reflectances for color error, noise per patch and total error; "
        "default: the ColorChecker.",
    )
    patch: float | str | None = Field(
        None,
        description="The patch that is analyzed: a number, e.g. 0.18, a patch of the ColorChecker "
        "or of the catalog, FILE or FILE:NAME; default: a perfect white.",
    )
    pairs: str | None = Field(
        None,
        description="Pairs of patches that a machine must tell apart: a CSV file with the header "
        "first,second and two patches of the ColorChecker or of the catalog per line, or a file of "
        "reflectances, all of whose pairs are taken; default: all pairs of the chart.",
    )
    scale: Literal["percent", "fraction"] | None = Field(
        None, description="Whether the files of reflectances are percent or fractions."
    )
    wavelength_unit: Unit | None = Field(
        None, description="Unit of the wavelengths in files of reflectances without one."
    )
    beyond: Beyond | None = Field(
        None,
        description="Values outside the range of the curves, also of the prior: refuse, zero or "
        "hold; default: that of the first sensor.",
    )

    @field_validator("patch", mode="before")
    @classmethod
    def _number_or_name(cls, given: Any) -> Any:
        """Give one error message; the schema alone would give one for each type of value."""
        if given is None or isinstance(given, str):
            return given
        if isinstance(given, bool) or not isinstance(given, int | float):
            raise ValueError("must be a number from 0 to 1, a name or a file")
        return _check.within("patch", "1", float(given), 0.0, 1.0)


class SensorPart(Part):
    """One sensor."""

    name: str = Field(
        description="Name of the catalog, or a file of QE curves, relative to the study's folder."
    )
    label: Annotated[str, Field(max_length=_LONGEST_LABEL), AfterValidator(_printable)] | None = (
        Field(None, description="Text in place of the name in tables and charts.")
    )
    beyond: Beyond = Field(
        "refuse",
        description="Values outside the range of the curves: refuse, zero or hold.",
    )
    answers: AnswersPart = Field(AnswersPart(), description="Metadata that its file lacks.")
    pixel: PixelPart = Field(PixelPart(), description="Changes to its pixel.")
    filter: str | None = Field(
        None, description="Filter on the sensor: ircut-650 or another of the catalog, or a file."
    )
    channel_filters: dict[str, str] | None = Field(
        None, description="Filters of single channels, as filter: R = ircut-650, W = a file."
    )
    filter_wavelength_unit: Unit | None = Field(
        None, description="Unit of the wavelengths, where the filter's file does not declare it."
    )
    shift_ircut_nm: _Shift = Field(
        0.0, description="Shift of the filter in wavelength, positive towards red [nm]."
    )
    negatives: Negatives = Field("refuse", description=_NEGATIVES)
    crosstalk: float | str | None = Field(
        None,
        description="Share of the light of a pixel that ends in its four neighbors, or a file: a "
        "table with one row and column per channel, or a kernel of neighbors without names.",
    )
    crosstalk_stage: Literal["light", "charge"] = Field(
        "light", description="Crosstalk before counting (light), or after it (charge: correlated)."
    )
    mosaic: Annotated[str, _spelled_as(MOSAIC_NAMES)] | None = Field(
        None,
        description="Mosaic, for crosstalk, figures of merit and pictures of the sensor's mosaic: "
        f"{', '.join(MOSAIC_NAMES)}, or rows, e.g. RG/GB or 'Red Yellow; Yellow Blue'; default: "
        "that of the sensor.",
    )
    ircut_nm: Annotated[float, Field(ge=450, le=2000)] | None = Field(
        None, description="Edge of an added model IR-cut [nm]."
    )
    shift_nm: _Shift = Field(
        0.0, description="Shift of all curves in wavelength, positive towards red [nm]."
    )

    @field_validator("crosstalk", mode="before")
    @classmethod
    def _share_or_file(cls, given: Any) -> Any:
        """Give one error message; the schema alone would give one for each type of value."""
        if isinstance(given, int | float) and not isinstance(given, bool):
            return _check.within("crosstalk", "1", float(given), 0.0, 1.0)
        if given is None or isinstance(given, str):
            return given
        raise ValueError("must be a share from 0 to 1, or the name of a file")


class ExposurePart(Part):
    """Exposure time, lens, and the rule by which the sensors are compared."""

    equal: Literal["exposure", "saturation", "light"] = Field(
        "exposure",
        description="Same for all sensors: exposure time; saturation; light per set of channels.",
    )
    time_ms: Annotated[Positive, _within("ms", 1e-12, 1e15)] | None = Field(
        None,
        description="Exposure time of all sensors [ms]; solved if omitted.",
    )
    saturate: Annotated[float, Field(gt=0, le=1), _within("of full well", 1e-9, 1.0)] = Field(
        0.99, description="Share of full well that a perfect white fills, if the time is solved."
    )
    f_number: Annotated[Positive, AfterValidator(_of_a_lens)] = Field(
        1.8, description="f-number of the lens."
    )
    magnification: Finite | None = Field(
        None,
        description="Magnification of the lens; if given, the camera equation is used.",
    )

    @model_validator(mode="after")
    def _one_rule(self, info: Any) -> "ExposurePart":
        if _shares_time(self) and not _keeps(info):
            raise InputError(
                "time_ms",
                "must not be given with a share of full well, from which the time is solved",
                value=self.time_ms,
                found=None,
                remedy=(Setting("time_ms", omit=True), Setting("saturate", omit=True)),
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

    vary: Annotated[str, _known(SWEEPS)] = Field(description="What varies too, as in the sweep.")
    first: Finite = Field(description="Lowest value of the second parameter, in its unit.")
    last: Finite = Field(description="Highest value of the second parameter.")
    points: Annotated[int, Field(ge=2, le=100_000)] = Field(
        21, description="Number of values of the second parameter."
    )


class SweepPart(Part):
    """One parameter that varies, or two, and the quantity to compute."""

    vary: Annotated[str, _known(SWEEPS)] = Field(description=f"What varies: {', '.join(SWEEPS)}.")
    first: Finite = Field(description="Lowest value, in the unit of the sweep.")
    last: Finite = Field(description="Highest value.")
    points: Annotated[int, Field(ge=2, le=100_000)] = Field(61, description="Number of values.")
    quantity: Annotated[str, _known(QUANTITIES)] = Field(
        "snr-y", description=f"One of {', '.join(QUANTITIES)}."
    )
    all_priors: bool = Field(False, description="Also the band of crossovers over all priors.")
    second: SecondSweepPart | None = Field(
        None, description="A second parameter that varies: values on a grid, and a heat map."
    )

    @model_validator(mode="after")
    def _of_two_parameters(self) -> "SweepPart":
        if self.second is None:
            return self
        if self.second.vary == self.vary:
            raise InputError(
                "vary",
                "must differ from the second parameter of the sweep",
                value=self.vary,
                found=None,
                remedy=("vary another thing", Setting("second.vary", omit=True)),
            )
        if self.all_priors:
            raise InputError(
                "all_priors",
                "must not be given with a second parameter",
                value=True,
                found=None,
                remedy="omit one of them",
            )
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
    {name: PIXEL[name] for name in PIXEL_NOISE}, "; default: from pixel.file, else 0."
)
class PicturePart(Part):
    """Pictures of one cube with every sensor, as `chromanoise simulate` renders them."""

    cube: Annotated[str, _spelled_as(BUILTIN_CUBES)] = Field(
        "builtin:checker", description=f"{', '.join(BUILTIN_CUBES)}, or a file."
    )
    key: str | None = Field(None, description="Name of the array in the cube's file.")
    shape: Annotated[tuple[int, int], Field(strict=False)] | None = Field(
        None, description="Rows and columns of a cube stored as a 2-D array."
    )
    wavelengths: Annotated[tuple[float, float], Field(strict=False)] | str | None = Field(
        None,
        description="If the cube does not declare them: first and last band [nm], or a text file "
        "with one wavelength per band.",
    )
    scale: Positive | None = Field(None, description="Reflectance per stored unit.")
    beyond: Beyond = Field(
        "refuse",
        description="Reflectances outside the range of the cube: refuse, zero or hold.",
    )
    bad_pixels: Literal["refuse", "zero"] = Field(
        "refuse", description="Treatment of values that are no reflectance: refuse or zero."
    )
    mosaic: Annotated[str, _spelled_as(MOSAIC_NAMES)] | None = Field(
        None,
        description=f"sensor (its own), {', '.join(MOSAIC_NAMES)}, or rows as RG/GB; without it "
        "all channels are at every pixel.",
    )
    demosaic: Annotated[str, _known(DEMOSAICING)] | None = Field(
        None, description=f"One of {', '.join(DEMOSAICING)}; default with a mosaic: bilinear."
    )
    raw_only: bool = Field(False, description="Only the raw codes of the mosaic, without color.")
    bits: Annotated[int, Field(ge=8, le=16)] | None = Field(
        None, description="Bits of the converter, with a mosaic; default: from pixel.file, else 12."
    )
    black_level: Annotated[int, Field(ge=0, lt=2**16)] | None = Field(
        None,
        description="Code without light, with a mosaic; default: from pixel.file, else 0.",
    )
    frames: Annotated[int, Field(ge=1, le=MOST_FRAMES)] = Field(1, description="Frames of a burst.")
    denoise: Annotated[str, _known(DENOISING)] | None = Field(
        None,
        description="Denoising of the electrons, with their known noise, before the color "
        f"matrix: one of {', '.join(DENOISING)}; default: none.",
    )
    formats: (
        Annotated[tuple[Annotated[str, _known(FORMATS)], ...], Field(strict=False, min_length=1)]
        | None
    ) = Field(None, description=f"{', '.join(FORMATS)}; default: png and xyz, or raw and dng.")
    clip: bool = Field(False, description="Clip electrons between 0 and full well.")

    @field_validator("wavelengths", mode="before")
    @classmethod
    def _ends_or_a_file(cls, given: Any) -> Any:
        """Give one error message; the schema alone would give one for each type of value."""
        pair = isinstance(given, list | tuple) and len(given) == 2
        numbers = pair and all(isinstance(n, int | float) for n in given)
        if given is None or isinstance(given, str) or numbers:
            return given
        raise ValueError("must be [FIRST, LAST] in nm, or the name of a file that lists them all")

    @model_validator(mode="after")
    def _of_a_mosaic(self) -> "PicturePart":
        given = {name: getattr(self, name) for name in _OF_MOSAIC}
        idle = [
            InputError(
                name,
                "must not be given without a mosaic",
                value=value,
                found=None,
                remedy=Setting("mosaic"),
            )
            for name, value in given.items()
            if value is not None and value is not False
        ]
        if self.mosaic is None and idle:
            raise refusal(idle)
        if self.mosaic is not None and self.clip:
            raise InputError(
                "clip",
                "must not be given with a mosaic, whose converter clips anyway",
                value=self.clip,
                found=None,
                remedy="omit one of them",
            )
        for name in ("demosaic", "denoise"):
            if self.raw_only and getattr(self, name) is not None:
                raise InputError(
                    name,
                    "must not be given where only raw codes are asked for",
                    value=getattr(self, name),
                    found=None,
                    remedy="omit one of them",
                )
        return self


_OF_MOSAIC = ("demosaic", "raw_only", "bits", "black_level")


class ParetoPart(Part):
    """Curve of color error against noise, for a range of weights of the noise."""

    first: Positive = Field(description="Lowest weight; 1 is LMMSE, towards 0 is least squares.")
    last: Positive = Field(description="Highest weight.")
    points: Annotated[int, Field(ge=2, le=100_000)] = Field(13, description="Number of weights.")


class PipelinePart(Part):
    """The camera's own pipeline: noise of the ColorChecker after each of its steps."""

    run: bool = Field(
        False, description="Noise of each patch after each step of the camera's pipeline."
    )
    white_balance: Annotated[tuple[Positive, ...], Field(strict=False)] | str = Field(
        "gray",
        description="gray: equal raw of an 18 % gray; illuminant: of the light; another "
        "illuminant, or a file; or one gain per channel.",
    )
    white_balance_pixels: Annotated[int, Field(ge=1, le=10**9)] | None = Field(
        None, description="Gray pixels from which the gains are estimated; default: exact gains."
    )
    exposure_gain: Positive = Field(1.0, description="Gain of linear RGB.")
    saturation: NotNegative = Field(
        1.0, description="Saturation around Rec. 709 luma; 0 is gray, 1 changes nothing."
    )
    tone: float | str = Field(
        "srgb", description=f"Tone curve: {', '.join(TONES)}, or a gamma, e.g. 2.2."
    )
    luma: Literal["bt709", "bt601"] = Field("bt709", description="Weights of Y'CbCr.")
    iso: Annotated[tuple[Positive, ...], Field(strict=False, min_length=1, max_length=100)] = Field(
        (BASE_ISO,),
        description="ISO settings; gain and exposure are those of the base ISO times and divided "
        "by the same factor.",
    )
    base_iso: Positive = Field(BASE_ISO, description="ISO of the sensor as it is given.")
    iso_read_noise_e: Annotated[tuple[NotNegative, ...], Field(strict=False)] | None = Field(
        None, description="Read noise at each ISO [e-]; default: the same at all."
    )

    @field_validator("white_balance", mode="before")
    @classmethod
    def _gains_or_a_name(cls, given: Any) -> Any:
        """Give one error message; the schema alone would give one for each type of value."""
        numbers = isinstance(given, list | tuple) and all(
            isinstance(n, int | float) and not isinstance(n, bool) and 0 < n < float("inf")
            for n in given
        )
        if isinstance(given, str) or (numbers and given):
            return given
        raise ValueError(
            "must be gray, illuminant, the name of an illuminant, or finite gains > 0, one per "
            "channel"
        )

    @field_validator("tone", mode="before")
    @classmethod
    def _name_or_gamma(cls, given: Any) -> Any:
        """As `_gains_or_a_name`."""
        if isinstance(given, bool) or not isinstance(given, str | int | float):
            raise ValueError(f"must be {', '.join(TONES)}, or a gamma")
        return given

    @model_validator(mode="after")
    def _that_has_an_effect(self, info: Any) -> "PipelinePart":
        pipeline_settings(self)
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            given = name in self.model_fields_set - {"run"} and not _keeps(info)
            if not self.run and (given or value != field.default):
                raise InputError(
                    name,
                    "must be given only with the pipeline",
                    value=value,
                    found=None,
                    remedy=(Setting("run", (True,)), "omit it"),
                )
        return self


def pipeline_settings(part: PipelinePart, light: Illuminant | None = None) -> PipelineSettings:
    """The settings of a pipeline.

    Parameters
    ----------
    part
        Of a study.
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

    analyses: bool = Field(True, description="Every stage of each sensor, per matrix.")
    clip: bool = Field(
        False, description="In the analyses, moments of electrons clipped between 0 and full well."
    )
    budget: bool = Field(
        True,
        description="SNR loss per cause [dB]: X, Y, Z, contravariant, L*, a*, b*.",
    )
    merit: bool = Field(False, description="Figures of merit: Vora, SMI, ISO speed, bits ...")
    chart: bool = Field(False, description="Color error and noise of every ColorChecker patch.")
    space: Annotated[str, _known(SPACES)] | None = Field(
        None, description="Noise of an 18 % gray in this color space."
    )
    reader: Literal["eye", "machine"] = Field(
        "eye",
        description="Who looks: an eye, by color and its noise, or a machine, by the distance of "
        "patches in raw values.",
    )
    matrix: bool = Field(False, description="Each color matrix, its color error and noise.")
    pipeline: PipelinePart = Field(
        PipelinePart(), description="The camera's own pipeline, from raw to Y'CbCr and Lab."
    )
    pareto: ParetoPart | None = Field(
        None, description="With matrix: the curve of color error against noise."
    )

    @model_validator(mode="after")
    def _that_go_together(self) -> "OutputsPart":
        unclipped = [name for name in ("budget", "merit") if getattr(self, name)]
        if self.clip and unclipped:
            raise InputError(
                "clip",
                f"must not be given with {' or '.join(unclipped)}: eq. 7 has no clipping",
                value=self.clip,
                found=None,
                remedy=(
                    Setting("clip", omit=True),
                    *(Setting(name, (False,)) for name in unclipped if len(unclipped) == 1),
                ),
            )
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
    pydantic.ValidationError
        If a field is missing, unknown or invalid, or a setting has no effect.
    """

    schema_number: Annotated[int, Field(ge=SCHEMA, le=SCHEMA)] = Field(
        SCHEMA, alias="schema", description=f"Version of this format: {SCHEMA}."
    )
    title: str = Field("", description="Title of the study.")
    metric: Annotated[str, _known(METRICS)] = Field(
        "quanta",
        description="Whether spectra are expressed in photons (quanta) or in energy.",
    )
    observer: Annotated[str, AfterValidator(_known_observer)] = Field(
        DEFAULT_OBSERVER,
        description=f"Observer of the colors: {', '.join(OBSERVERS)}, or a file of color-matching "
        "functions x, y, z; a lux is always CIE 1931.",
    )
    seed: Annotated[int, Field(ge=0, lt=2**32)] = Field(0, description="Seed of all random noise.")
    light: LightPart = Field(LightPart(), description="The light on the scene.")
    exposure: ExposurePart = Field(ExposurePart(), description="Exposure time and lens.")
    sensors: Annotated[
        tuple[SensorPart, ...],
        Field(min_length=1, max_length=MOST_SENSORS, strict=False, description="One or more."),
    ]
    matrices: Annotated[
        tuple[Annotated[str, AfterValidator(_known_matrix)], ...],
        Field(min_length=1, strict=False),
    ] = Field(
        (DEFAULT_METHOD,),
        description=f"Color matrices: {', '.join(METHODS)}; ridge=0.01; or files.",
    )
    prior: Annotated[str, AfterValidator(_known_prior)] = Field(
        DEFAULT_PRIOR,
        description=f"Training set of trained matrices: {', '.join(PRIORS)}; or a file.",
    )
    reflectances: ReflectancesPart = Field(
        ReflectancesPart(), description="Own reflectances as chart and as patch."
    )
    sweeps: Annotated[
        tuple[SweepPart, ...],
        Field(
            strict=False,
            description="Sweeps, computed one after the other.",
        ),
    ] = ()
    pictures: Annotated[
        tuple[PicturePart, ...],
        Field(
            strict=False,
            description="Pictures of cubes with every sensor.",
        ),
    ] = ()
    outputs: OutputsPart = Field(OutputsPart(), description="Outputs of the run.")

    @model_validator(mode="after")
    def _without_idle_settings(self, info: Any) -> "Study":
        errors = [] if _keeps(info) else [*_idle_priors(self), *_replaced_settings(self)]
        if errors:
            raise refusal(errors)
        return self


StudyKind = TypeVar("StudyKind", bound=Study)
"""A study, or a document that has the tables of a study and others."""


def _keeps(info: Any) -> bool:
    return bool((info.context or {}).get("keep_idle"))


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
        value: Any = study
        for step in one.split("."):
            value = value[int(step)] if step.isdigit() else getattr(value, step)
        if value is not None:
            yield InputError(
                one.rpartition(".")[2],
                "must not be given where it varies",
                value=value,
                found=None,
                remedy="omit it, or vary another thing",
                setting=one,
            )


def without_idle_settings(study: Study) -> Study:
    """A study that was checked with `KEEP_IDLE`, without the settings that have no effect.

    Parameters
    ----------
    study
        Of the page.

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
        *path, last = key.split(".")
        at: Any = data
        for step in path:
            at = at[int(step) if step.isdigit() else step]
        at.pop(last, None)
    return Study.model_validate(data)


def study_schema() -> dict[str, Any]:
    """The JSON Schema of a study file, for editors and other programs."""
    return Study.model_json_schema(by_alias=True) | {
        "$schema": "https://json-schema.org/draft/2020-12/schema"
    }
