"""Results of a characterization: planes, quantities and a verdict; written and read as JSON."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, ClassVar, get_args, get_origin

import numpy as np

from chromanoise.base import (
    VERSION,
    Array,
    Float,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    defined,
    from_above,
)
from chromanoise.io import Column, Entry, Result, Table, axes_of
from chromanoise.io.pixels import finite_number
from chromanoise.sensor import (
    PAPER_PIXEL,
    PIXEL,
    ROUNDING_DN2,
    SOURCES,
    Drawn,
    Mosaic,
    PartialPixel,
    PixelReading,
    TransferFit,
)

STATED = "write {} in capture.toml, as in the files of the camera"
"""Remedy for a fact that neither the frames nor their description state."""
SCHEMA = "chromanoise characterization"
SCHEMA_VERSION = 1


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A value of a plane, as tables list it.

    Attributes
    ----------
    field
        Its field in `PlaneNoise`; ``field_se``, where it exists, has the standard error.
    """

    name: str
    unit: str
    field: str

    def of(self, plane: "PlaneNoise") -> tuple[float | None, float | None]:
        """The value of a plane and its standard error, ``None`` where it is not known or finite."""
        value, error = getattr(plane, self.field), getattr(plane, f"{self.field}_se", None)
        return defined(value), defined(error)

    def shown(self, plane: "PlaneNoise") -> tuple[float | None, float | None]:
        """As `of`, in `shown_unit`."""
        scale = 100 if self.is_share else 1
        value, error = (None if one is None else scale * one for one in self.of(plane))
        return value, error

    @property
    def is_share(self) -> bool:
        """Whether tables for readers have it in percent."""
        return self.field == "qe" or (self.field in PIXEL and self.unit == "1")

    @property
    def shown_unit(self) -> str:
        """The unit in tables for readers: percent for shares, empty for counts."""
        return "%" if self.is_share else self.unit.removeprefix("1")


@dataclass(frozen=True, kw_only=True)
class LevelNoise:
    """One plane at one level of light.

    Attributes
    ----------
    frames
        Number of flats. [1]
    time_ms, photons_per_pixel
        As `chromanoise.io.frames.FrameLevel`; ``None`` if not known. [ms], [1]
    mean_dn
        Mean code. [DN]
    variance_dn2, variance_se_dn2
        Temporal variance and its standard error. [DN^2]
    predicted_variance_dn2
        K times the mean above dark, plus the dark variance. [DN^2]
    dark_mean_dn, dark_variance_dn2
        Of the darks of the level; ``None`` if there are none. [DN], [DN^2]
    fitted
        Whether the level is below 70 % of saturation, so that K was fitted to it.
    clipped_share
        Share of the pixels at the largest code. [1]
    correlation_right, correlation_down
        Temporal correlation of neighbors in a row, and in a column, of the same plane. [1]
    drift_z
        Largest change of the mean from one frame to another, over its standard error without drift.
    """

    name: str
    frames: int
    time_ms: float | None
    photons_per_pixel: float | None
    mean_dn: float
    variance_dn2: float
    variance_se_dn2: float
    predicted_variance_dn2: float
    dark_mean_dn: float | None
    dark_variance_dn2: float | None
    fitted: bool
    clipped_share: float
    correlation_right: float
    correlation_down: float
    drift_z: float

    @property
    def samples(self) -> float | None:
        """Samples that give the standard error of the variance; ``None`` without an error. [1]"""
        if not self.variance_se_dn2 > 0 or not self.variance_dn2 > 0:
            return None
        samples = 1 + 2 * (self.variance_dn2 / self.variance_se_dn2) ** 2
        return samples if 2 <= samples <= 1e12 else None


@dataclass(frozen=True, kw_only=True)
class PlaneNoise(PartialPixel):
    """Noise of one plane of the mosaic, named as in EMVA 1288; ``_se`` are standard errors.

    The properties of `Pixel` that have a standard error below, and: DSNU and PRNU are fixed-pattern
    noise; row and column noise is what all pixels of a row, or column, share in the dark. The full
    well is that of a saturated level, if there is one; otherwise of the mean code at the largest
    variance, with a standard error that includes the spacing of the levels. The dark current is
    from darks at three or more exposure times.

    Attributes
    ----------
    name
        The channel: ``R``, ``G1``, ``G2``, ``B``; ``mono`` without a mosaic.
    gain_dn_per_e, gain_dn_per_e_se
        System gain K. [DN/e-]
    dark_noise_e, dark_noise_e_se
        Temporal dark noise sigma_d, rounding not included. [e-]
    black_level_dn, black_level_dn_se
        Mean code without light at exposure time 0. [DN]
    saturation_dn, saturation_capacity_e
        Mean code at the largest variance, and QE times the photons of that level (EMVA 1288:
        mu_e.sat = eta mu_p.sat); if the photons are not known, the electrons of that code. [DN],
        [e-]
    full_well_e_se, dark_current_e_per_s_se, dsnu_e_se, prnu_se, row_noise_e_se, column_noise_e_se
        Standard errors of the properties of the pixel, in their units.
    dynamic_range_db
        20 log10 of the ratio of the saturation capacity to the absolute sensitivity threshold
        sqrt(dark noise^2 + 1 / (12 K^2)) + 0.5 e- (EMVA 1288: mu_e.sat / mu_e.min). [dB]
    qe, qe_se
        Electrons per photon, where ``photons_per_pixel`` is given. [e-/photon]
    linearity_error_percent
        Largest deviation of the mean from a straight line over light. [%]
    dsnu_of_own_frames_e
        DSNU after subtraction of the temporal noise of the averaged darks only, as in the reference
        code of EMVA 1288. For ``dsnu_e``, the subtracted row and column noise is the mean over all
        darks, because two frames have few rows; with a spatial series both are equal. [e-]
    hot_pixels
        Pixels whose dark mean is far above that of the others. [1]
    bend_z
        Quadratic term of the variance over its standard error; a bend is significant above 3.
    levels
        From dark to bright.
    """

    name: str
    gain_dn_per_e: float
    gain_dn_per_e_se: float
    dark_noise_e: float | None = None
    dark_noise_e_se: float | None = None
    black_level_dn: float | None = None
    black_level_dn_se: float | None = None
    saturation_dn: float | None = None
    saturation_capacity_e: float | None = None
    full_well_e_se: float | None = None
    dynamic_range_db: float | None = None
    qe: float | None = None
    qe_se: float | None = None
    linearity_error_percent: float | None = None
    dark_current_e_per_s_se: float | None = None
    dsnu_e_se: float | None = None
    dsnu_of_own_frames_e: float | None = None
    prnu_se: float | None = None
    row_noise_e_se: float | None = None
    column_noise_e_se: float | None = None
    hot_pixels: int | None = None
    bend_z: float | None = None
    levels: tuple[LevelNoise, ...]
    fit: TransferFit

    @property
    def dark_variance_dn2(self) -> float | None:
        """Variance of the codes without light, rounding included; ``None`` if unknown. [DN^2]"""
        if self.dark_noise_e is None:
            return None
        return (self.gain_dn_per_e * self.dark_noise_e) ** 2 + ROUNDING_DN2


MEASURED = tuple(name for name in PIXEL if f"{name}_se" in {one.name for one in fields(PlaneNoise)})
"""Properties of a pixel that are measured."""
_PLANE_KEYS = tuple(
    one.name for one in fields(PlaneNoise) if one.name in MEASURED or one.name not in PIXEL
)


def _drawn(name: str) -> set[Drawn]:
    """How the noise of a property of the pixel is drawn, by the list of sources."""
    without = PixelReading(pixel=PAPER_PIXEL)
    with_it = PixelReading(pixel=replace(PAPER_PIXEL, **{name: PIXEL[name].most}))
    return {one.drawn for one in SOURCES if one.value(with_it) != one.value(without)}


SPREADS = {name: PIXEL[name] for name in MEASURED if _drawn(name)}
"""Measured properties of a pixel that are standard deviations."""
SHARED = tuple(name for name in SPREADS if _drawn(name) <= {"row", "column"})
"""Those that a row or a column shares."""
QUANTITIES = tuple(
    Quantity(name=name, unit=unit, field=field)
    for name, unit, field in (
        ("gain K", "DN/e-", "gain_dn_per_e"),
        ("dark noise", "e-", "dark_noise_e"),
        ("black level", "DN", "black_level_dn"),
        ("full well", "e-", "full_well_e"),
        ("saturation", "DN", "saturation_dn"),
        ("dynamic range", "dB", "dynamic_range_db"),
        ("QE", "e-/photon", "qe"),
        ("linearity error", "%", "linearity_error_percent"),
        *((PIXEL[one].label, PIXEL[one].unit, one) for one in MEASURED if one != "full_well_e"),
        ("hot pixels", "1", "hot_pixels"),
        ("bend of the variance, z", "1", "bend_z"),
    )
)
"""The values of a plane in the order of tables."""


@dataclass(frozen=True, kw_only=True)
class ModelVerdict:
    """Whether the camera follows the linear model: variance = K mean + dark variance, white.

    Attributes
    ----------
    holds
        Whether no statement was made against it.
    chi2_per_level
        Mean squared deviation of the variance from the model, over its standard error.
    worst_level, worst_z
        The level that deviates most, and its deviation in standard errors.
    sentences
        What contradicts the model: bend, correlation, drift, clipping; each names its frames.
    """

    holds: bool
    chi2_per_level: float
    worst_level: str
    worst_z: float
    sentences: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Characterization(Result):
    """Noise of a camera from its own frames.

    Attributes
    ----------
    source
        Folder or file of the frames.
    camera
        Maker and model, or empty.
    iso
        ISO setting of the frames; ``None`` if not known.
    bits
        Bits of the codes; ``None`` if not known.
    mosaic
        Names of the planes in one period of the mosaic; ``None`` for a monochrome sensor.
    planes
        One per pixel of the period.
    correlation
        Temporal correlation between the planes of one cell, at the middle level.
    covariance_dn2
        Temporal covariance of the planes of one cell, at each level from dark to bright. [DN^2]
    verdict
        Whether the linear model holds.
    notes
        How frames were grouped, and remarks.

    Raises
    ------
    InputError
        If the covariances are not those of the planes.
    """

    KEYS: ClassVar[JsonKeys] = (
        JsonKey("schema", lambda _: SCHEMA),
        JsonKey("schema_version", lambda _: SCHEMA_VERSION),
        VERSION,
        *("source", "camera", "iso", "bits"),
        JsonKey("mosaic", "mosaic.pattern"),
        JsonKey("planes", keys=_PLANE_KEYS),
        *("correlation", "covariance_dn2", "verdict", "notes"),
    )
    source: str
    camera: str
    iso: float | None
    bits: int | None
    mosaic: Mosaic | None
    planes: tuple[PlaneNoise, ...]
    correlation: Float[Array, "p p"]
    covariance_dn2: Float[Array, "k p p"]
    verdict: ModelVerdict
    notes: tuple[str, ...]

    def __post_init__(self) -> None:
        count = len(self.planes)
        check.same_length("planes", planes=count, correlation=len(self.correlation))
        check.same_length("planes", planes=count, covariance=self.covariance_dn2.shape[-1])
        check.freeze(self, "correlation", "covariance_dn2")

    def to_table(self) -> Table:
        """One row per value, with a column of values and one of standard errors for each plane."""
        columns = [Column(name="value"), Column(name="unit")]
        for plane in self.planes:
            columns += [
                Column(name=plane.name, digits=".4g"),
                Column(name=f"{plane.name} standard error", digits=".2g"),
            ]
        rows: list[tuple[Entry, ...]] = [
            (one.name, one.unit, *(cell for plane in self.planes for cell in one.of(plane)))
            for one in QUANTITIES
        ]
        return Table(
            title=self._title(),
            columns=tuple(columns),
            rows=tuple(rows),
            notes=(self._holds(), *self.verdict.sentences),
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw the photon transfer of each plane. [DN^2]

        Parameters
        ----------
        ax
            Axes of matplotlib; ``None`` for those of a new figure.

        Returns
        -------
        Axes
        """
        return from_above("camera").draw_characterization(self, axes_of(ax))

    def _title(self) -> str:
        iso = "" if self.iso is None else f", ISO {self.iso:g}"
        return f"Noise of {self.camera or Path(self.source).name}{iso} (EMVA 1288)"

    def _holds(self) -> str:
        return f"the linear model {'holds' if self.verdict.holds else 'does not hold'}"

    def _repr_html_(self) -> str:
        return self._html(self._title(), (self._holds(), *self.verdict.sentences))

    def __repr__(self) -> str:
        """Planes with gain and dark noise, and whether the linear model holds."""
        planes = ", ".join(
            f"{plane.name} {plane.gain_dn_per_e:.4g} DN/e-"
            + ("" if plane.dark_noise_e is None else f" {plane.dark_noise_e:.3g} e-")
            for plane in self.planes
        )
        return f"<Characterization: {planes}; {self._holds()}>"


def several(results: Characterization | Sequence[Characterization]) -> list[Characterization]:
    """One result, or several, as a list."""
    return [results] if isinstance(results, Characterization) else list(results)


def by_iso(results: Sequence[Characterization]) -> list[tuple[float, Characterization]]:
    """The noise of one camera at each ISO setting, in increasing order.

    Parameters
    ----------
    results
        One characterization per ISO setting.

    Raises
    ------
    InputError
        If there is none, the cameras differ, or an ISO is missing or repeated.
    """
    if not results:
        raise InputError("results", "must hold at least one characterization", value=0)
    for name in ("camera", "bits", "mosaic"):
        other = next((o for o in results if getattr(o, name) != getattr(results[0], name)), None)
        if other is not None:
            raise InputError(
                "results",
                f"must be of one camera, but the {name} differs",
                value=(str(getattr(results[0], name)), str(getattr(other, name))),
                where=other.source,
            )
    found = [(one.iso, one) for one in results if one.iso is not None]
    if len({iso for iso, _ in found}) < len(results):
        raise InputError(
            "iso",
            "must be known and different in each of several characterizations",
            value=[one.iso for one in results],
            remedy=STATED.format("iso = 100"),
        )
    return sorted(found, key=lambda pair: pair[0])


def characterization_as_json(result: Characterization) -> dict[str, Any]:
    """All numbers of a characterization with all digits, as plain data for ``json.dumps``.

    Returns
    -------
    dict
        ``schema``, ``schema_version``, ``version`` and the fields of `Characterization`; the
        mosaic is a list of rows, ``planes`` a list of objects with the fields of `PlaneNoise` but
        the properties of a pixel that are not measured. A value that is not known or not finite is
        ``None``.
    """
    return result.to_dict()


def plane_names(mosaic: Mosaic | None) -> tuple[str, ...]:
    """Names of the planes, in the order of the pixels of a period; repeated channels are numbered.

    Examples
    --------
    >>> from chromanoise.sensor import bayer
    >>> plane_names(bayer()), plane_names(None)
    (('R', 'G1', 'G2', 'B'), ('mono',))
    """
    return ("mono",) if mosaic is None else mosaic.place_names


_LEAST_SIGNAL_E = 0.5  # added to the dark noise: EMVA 1288, eq. of the absolute threshold
_MOST = 1e15
_AXES = {"correlation": 2, "covariance_dn2": 3}
_POSITIVE = (".gain_dn_per_e",)
_NOT_NEGATIVE = ("_noise_e", "_se", *(f".{name}" for name in SPREADS))
_REMEDY = "give the file as chromanoise characterize wrote it"


def threshold_e(gain_dn_per_e: float, dark_noise_e: float | None) -> float | None:
    """The absolute sensitivity threshold; ``None`` without dark noise. [e-]

    Parameters
    ----------
    dark_noise_e
        Temporal dark noise, rounding not included. [e-]

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear: sqrt(sigma_d^2 + 1 / (12 K^2)) + 1/2.
    """
    if dark_noise_e is None:
        return None
    return math.sqrt(dark_noise_e**2 + ROUNDING_DN2 / gain_dn_per_e**2) + _LEAST_SIGNAL_E


def dynamic_range_db(capacity_e: float | None, least_e: float | None) -> float | None:
    """20 log10 of the saturation capacity over `threshold_e`; ``None`` if one is unknown. [dB]

    Parameters
    ----------
    capacity_e, least_e
        Of a plane. [e-]

    Notes
    -----
    EMVA Standard 1288, release 4.0 Linear: mu_e.sat / mu_e.min.
    """
    return 20 * math.log10(capacity_e / least_e) if capacity_e and least_e else None


def is_characterization(data: Any) -> bool:
    """Whether data of JSON name the schema of a characterization."""
    return isinstance(data, dict) and data.get("schema") == SCHEMA


def characterization_from_json(data: Mapping[str, Any], source: str) -> Characterization:
    """The characterization that `characterization_as_json` made into plain data, with all digits.

    Parameters
    ----------
    source
        Name of the file, for messages.

    Raises
    ------
    InputError
        If a field is missing or not of its kind, or the version of the schema is another.
    """
    if data.get("schema") != SCHEMA or data.get("schema_version") != SCHEMA_VERSION:
        raise InputError(
            source,
            f"must have the schema {SCHEMA!r} and schema_version {SCHEMA_VERSION}",
            value=(data.get("schema"), data.get("schema_version")),
            remedy=_REMEDY,
        )
    return _value(Characterization, data, source, "")


def _wrong(source: str, where: str, value: Any) -> InputError:
    return InputError(
        source, "must be as in a characterization", value=value, where=where, remedy=_REMEDY
    )


def _wrong_unless(kind: type, value: Any, source: str, where: str) -> Any:
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise _wrong(source, where, value)
    return value


def _value(kind: Any, value: Any, source: str, where: str) -> Any:
    """A value of the type of a field of the nouns, or a noun."""
    if get_origin(kind) is Annotated:
        kind = get_args(kind)[0]
    if isinstance(kind, UnionType):
        first = next(one for one in get_args(kind) if one is not type(None))
        return None if value is None else _value(first, value, source, where)
    if kind is Mosaic:
        try:
            return Mosaic(tuple(tuple(row) for row in value))
        except (TypeError, AttributeError):
            raise _wrong(source, where, value) from None
    if isinstance(kind, type) and is_dataclass(kind):
        held = _wrong_unless(dict, value, source, where)
        inside = f"{where}." if where else ""
        return kind(
            **{
                one.name: _value(one.type, held.get(one.name), source, f"{inside}{one.name}")
                for one in fields(kind)
                if kind is not PlaneNoise or one.name in _PLANE_KEYS
            }
        )
    if get_origin(kind) is tuple:
        of = get_args(kind)[0]
        entries = _wrong_unless(list, value, source, where)
        return tuple(_value(of, one, source, f"{where}[{i}]") for i, one in enumerate(entries))
    if kind is float:
        return _number(value, source, where)
    if kind in (str, int, bool):
        return _wrong_unless(kind, value, source, where)
    return _array(value, source, where)


def _number(value: Any, source: str, where: str) -> float:
    """A number; NaN for null, as which a number that is not finite is written."""
    if value is None and not where.endswith(_POSITIVE):
        return float("nan")
    number = finite_number(value)
    if (
        number is None
        or abs(number) > _MOST
        or (number < 0 and where.endswith(_NOT_NEGATIVE))
        or (number <= 0 and where.endswith(_POSITIVE))
    ):
        raise _wrong(source, where, value)
    return number


def _array(value: Any, source: str, where: str) -> Any:
    try:
        array = np.array(_wrong_unless(list, value, source, where))
    except ValueError:
        raise _wrong(source, where, value) from None
    flags = array.dtype == bool
    if array.ndim != _AXES.get(where, 1) or not (flags or array.dtype.kind in "if"):
        raise _wrong(source, where, value)
    return array if flags else check.finite(f"{where} of {source}", "1", array)
