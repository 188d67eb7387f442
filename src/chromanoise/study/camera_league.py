"""The cameras of the catalog and further sensors, ranked at equal light on equal area.

Everything is seen in D50 with the white-preserving matrix of the 190 patches of rawtoaces. Color
SNR loss, color error, SMI and the colors at equal saturation depend on the filters alone. At an ISO
speed S, an 18 % gray has the exposure 10 / S lx s on the sensor (ISO 12232:2019), and all noise is
that of the pixels of one area, so that neither the lens nor the size of the pixels decides.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache, partial
from math import isclose, isfinite, log2, sqrt
from operator import attrgetter
from typing import Any, ClassVar

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
    kept,
    refusal,
)
from chromanoise.color import ColorMatrix, Training, colored, training_color_error, white_preserving
from chromanoise.io import Result, Table, axes_of, figures, table_of
from chromanoise.metrics import (
    color_sensitivity_bits,
    color_snr_loss_db,
    distinguishable_colors_bits,
    pair_distances,
    sensor_metamerism,
)
from chromanoise.noise import OperatingPoint, saturated, with_noise
from chromanoise.sensor import UNKNOWN_CONVERTER, Pixel, Sensor
from chromanoise.spectra import (
    Grid,
    Illuminant,
    Spectra,
    all_pairs,
    colorchecker,
    illuminant_named,
    on_grid,
)
from chromanoise.spectra.tables import OWN_PEAKS, CameraFacts, camera_facts, packaged_table
from chromanoise.study.analysis import electrons_at
from chromanoise.study.assembly import (
    NOTHING_GIVEN,
    Given,
    distinct_names,
    duplicates,
    sensor_of,
)
from chromanoise.study.cameras import AT_THE_SENSOR, GRAY_LUX_S, camera_pixel
from chromanoise.study.catalog import assumptions, is_assumed, sensor_named
from chromanoise.study.color_noise import GRAY, USUAL_VIEWING, noise_as_viewed
from chromanoise.study.schema import Study

GRID = Grid.uniform(400, 780, 5)
"""The curves of the cameras and the training set end at 780 nm; those of other sensors are cut."""
LIGHT = "D50"
TRAINING = "patches-190"
SIDE_UM = 4.0
"""Side of the area whose pixels are summed. [um]"""
SATURATION_E = 10_000.0
"""Electrons of a white in the most sensitive channel, at equal saturation. [e-]"""
BLOCKS_NM = ((400.0, 485.0), (490.0, 575.0), (580.0, 700.0))
"""Each distinguishable color is a reflectance that is constant on these. [nm]"""
_SHUTTER_S = 0.01  # of all exposures; it decides on dark current alone


@dataclass(frozen=True, kw_only=True)
class Ranked:
    """A number by which the league ranks.

    Attributes
    ----------
    name
        Name of its field in a `LeagueEntry`.
    label, unit, digits
        Heading, unit and format of its numbers in tables.
    more_is_better
        Whether the best has the most.
    of_heights
        Whether the relative heights of the channels count: then curves that are divided by their
        own peaks have no rank.
    spread
        Root mean square of the differences between two measurements of one camera, over six
        cameras that another laboratory measured too, or five where relative heights count: those
        that differ by less tie.
    """

    name: str
    label: str
    unit: str
    digits: str
    more_is_better: bool
    of_heights: bool
    spread: float


RANKED = (
    Ranked(
        name="color_snr_loss_db",
        label="color SNR loss",
        unit="dB",
        digits=".2f",
        more_is_better=False,
        of_heights=True,
        spread=0.16,
    ),
    Ranked(
        name="color_error",
        label="color error",
        unit="Delta E*ab",
        digits=".2f",
        more_is_better=False,
        of_heights=False,
        spread=0.34,
    ),
    Ranked(
        name="smi",
        label="SMI",
        unit="",
        digits=".1f",
        more_is_better=True,
        of_heights=False,
        spread=1.1,
    ),
    Ranked(
        name="colors_bits",
        label="colors",
        unit="bit",
        digits=".2f",
        more_is_better=True,
        of_heights=True,
        spread=0.065,
    ),
)
"""What depends on the filters alone; the first decides the order of the table."""


@dataclass(frozen=True, kw_only=True)
class AtIso:
    """One sensor at one ISO speed, per equal area.

    Attributes
    ----------
    iso
        ISO speed. [1]
    read_noise_e
        Of one pixel; ``None`` if unknown, and then all noise is. [e-]
    saturated
        Whether a channel saturates on a white; then there is no noise either.
    visual_noise
        Of an 18 % gray as viewed. [CIELUV]
    colors_bits
        log2 of the number of colors that the best unbiased estimator distinguishes. [bit]
    colors_of_matrix_bits
        The same after the color matrix. [bit]
    cube_bits
        Raw values of a cube up to each channel's white: color sensitivity of DxOMark, which no
        filter changes at equal electrons. [bit]
    median_distance
        Distance D_M of the median pair of patches of the ColorChecker. [1]
    """

    iso: float
    read_noise_e: float | None
    saturated: bool = False
    visual_noise: float | None = None
    colors_bits: float | None = None
    colors_of_matrix_bits: float | None = None
    cube_bits: float | None = None
    median_distance: float | None = None


@dataclass(frozen=True, kw_only=True, eq=False)
class LeagueEntry:
    """One sensor of a league.

    Attributes
    ----------
    name
        The name in the catalog, or of a sensor of one's own, with a number where it is repeated.
    camera
        Maker and model; empty for a sensor of one's own.
    has_own_peaks
        Whether each channel is divided by its own peak: then only color error and SMI have a rank.
    color_snr_loss_db
        SNR of the best linear readout of a white minus that of Y, for shot noise alone. [dB]
    color_error
        Mean color error over the 190 patches. [Delta E*ab]
    smi
        Sensitivity metamerism index of ISO 17321-1. [1]
    colors_bits
        log2 of the number of colors that shot noise leaves distinct at equal saturation. [bit]
    ranks
        Rank of each of these among the cameras, 1 for the best; none of loss and colors where the
        curves are divided by their own peaks.
    ties
        Names of the cameras from which each does not differ by more than two measurements of one
        camera.
    iso
        Noise at each ISO speed.
    notes
        Source of the curves, their defects, and what is assumed of the sensor.
    """

    KEYS: ClassVar[JsonKeys] = (
        *("name", "camera", "color_snr_loss_db", "color_error", "smi", "colors_bits"),
        "has_own_peaks",
        *("ranks", "ties", "iso", "notes"),
    )

    name: str
    camera: str
    has_own_peaks: bool
    color_snr_loss_db: float
    color_error: float
    smi: float
    colors_bits: float
    iso: tuple[AtIso, ...]
    notes: tuple[str, ...]
    ranks: Mapping[str, int]
    ties: Mapping[str, tuple[str, ...]]

    def with_unit(self, by: Ranked) -> str:
        """A number with its unit."""
        unit = by.unit.replace("Delta E", "ΔE")
        return f"{format(getattr(self, by.name), by.digits)} {unit}".strip()

    def rank(self, by: Ranked) -> str:
        """The rank by a number, with ``=`` where it ties with others; empty without one."""
        if by.name not in self.ranks:
            return ""
        return f"{self.ranks[by.name]}{'=' if self.ties[by.name] else ''}"


OF_FILTERS = (
    f"light {LIGHT}, matrix white-preserving and trained on the 190 patches of rawtoaces (SMI: D55 "
    f"and its own matrix); {GRID.wavelength_nm[0]:g} to {GRID.wavelength_nm[-1]:g} nm"
)
"""What the numbers of spectral sensitivities hold for."""
CONDITIONS = (
    f"{OF_FILTERS}; visual noise of an 18 % gray at {GRAY_LUX_S:g}/ISO lx s on the sensor, scaled "
    f"to a pixel area of {SIDE_UM:g} x {SIDE_UM:g} um, with an assumed "
    "peak QE of each camera; = marks a tie: a difference below that of "
    "two measurements of one camera"
)
"""What all numbers of a league hold for."""


@cache
def _light() -> Illuminant:
    return illuminant_named(LIGHT, GRID)


@cache
def _training() -> Training:
    patches = on_grid(packaged_table(TRAINING), GRID)
    return Training(
        illuminant=_light(),
        reflectance=patches.values.T,
        names=patches.names,
        source=TRAINING,
        notes=patches.notes,
    )


def _of_filters(sensor: Sensor) -> tuple[ColorMatrix, dict[str, float]]:
    """The white-preserving matrix, and the number of each of `RANKED` by name."""
    quiet = replace(
        sensor,
        pixel=Pixel(pitch_um=SIDE_UM, full_well_e=SATURATION_E, read_noise_e=0.0),
        converter=UNKNOWN_CONVERTER,
    )
    dim = OperatingPoint(sensor=quiet, exposure=AT_THE_SENSOR, illuminant=_light(), level_lux=1.0)
    most_e = float(electrons_at(dim).max())
    if most_e == 0:
        need = f"must see light at {GRID.wavelength_nm[0]:g} to {GRID.wavelength_nm[-1]:g} nm"
        raise InputError(sensor.label, need, value=most_e, found="sees none", remedy="leave it out")
    point = replace(dim, level_lux=SATURATION_E / most_e)
    seen = (quiet, point.exposure, _training())
    matrix = white_preserving(*seen, level_lux=point.level_lux)
    raw = with_noise(electrons_at(point), quiet, point.exposure)
    error = training_color_error(*seen, matrix, level_lux=point.level_lux)
    if error is None:
        raise InputError(sensor.name, "must have X, Y and Z of a white above 0", value=None)
    bits = distinguishable_colors_bits(_blocks_e(point), read_noise_e=0.0)
    if not isfinite(bits):
        need = "must have channels that tell three colors apart"
        raise InputError(sensor.label, need, value=bits, found="has none", remedy="leave it out")
    return matrix, {
        "color_snr_loss_db": float(color_snr_loss_db(raw, colored(raw, matrix))),
        "color_error": error,
        "smi": sensor_metamerism(quiet).index,
        "colors_bits": bits,
    }


def point_at_iso(sensor: Sensor, iso: float) -> OperatingPoint:
    """A sensor in the light of the league at the exposure of an ISO speed.

    Parameters
    ----------
    sensor
        With its pixel at this ISO speed, on the grid of the catalog.
    iso
        ISO speed. [1]

    Returns
    -------
    OperatingPoint
        In D50, with an 18 % gray at 10 / S lx s on the sensor, at 400 to 780 nm.

    Raises
    ------
    InputError
        If it has fewer than 3 channels.
    """
    return OperatingPoint(
        sensor=_on_grid(sensor),
        exposure=replace(AT_THE_SENSOR, time_s=_SHUTTER_S),
        illuminant=_light(),
        level_lux=GRAY_LUX_S / GRAY / iso / _SHUTTER_S,
    )


def _at_iso(point: OperatingPoint, iso: float, matrix: ColorMatrix, *, known: bool) -> AtIso:
    """Noise of a sensor whose read noise at this ISO speed is known, or not."""
    sensor, exposure = point.sensor, point.exposure
    white_e = electrons_at(point)
    full = bool(saturated(white_e, sensor, exposure).any())
    if not known or full:
        read_noise_e = sensor.pixel.read_noise_e if known else None
        return AtIso(iso=iso, read_noise_e=read_noise_e, saturated=full)
    pixels = (SIDE_UM / sensor.pixel.pitch_um) ** 2
    dark_e2 = with_noise(np.zeros_like(white_e), sensor, exposure).variance.mean()
    dark = {"read_noise_e": sqrt(pixels * dark_e2)}
    blocks_e = pixels * _blocks_e(point)
    patches = with_noise(electrons_at(point, reflectance=_chart().values.T), sensor, exposure)
    distances = pair_distances(patches, all_pairs(_chart()).indices)
    viewed = noise_as_viewed(white_e, sensor, exposure, matrix.matrix, USUAL_VIEWING)
    best, of_matrix = (
        distinguishable_colors_bits(blocks_e, matrix=reader, **dark)
        for reader in (None, matrix.matrix)
    )
    return AtIso(
        iso=iso,
        read_noise_e=sensor.pixel.read_noise_e,
        visual_noise=float(viewed) / sqrt(pixels),
        colors_bits=best,
        colors_of_matrix_bits=of_matrix,
        cube_bits=float(color_sensitivity_bits(pixels * white_e, **dark)),
        median_distance=float(np.median(distances)) * sqrt(pixels),
    )


def _blocks_e(point: OperatingPoint) -> Float[Array, "p d"]:
    """Electrons of reflectances that are 1 on a block of wavelengths. [e-]"""
    at = GRID.wavelength_nm
    blocks = np.array([(first <= at) & (at <= last) for first, last in BLOCKS_NM], dtype=float)
    return electrons_at(point, reflectance=blocks).T


@cache
def _chart() -> Spectra:
    return colorchecker(GRID)


def _on_grid(sensor: Sensor) -> Sensor:
    """A sensor on the grid of the league, which is the first part of its own."""
    if len(sensor.names) < len(BLOCKS_NM):
        raise InputError(
            sensor.label,
            f"must have at least {len(BLOCKS_NM)} channels",
            value=len(sensor.names),
            found=f"has {len(sensor.names)}",
            remedy="leave it out",
        )
    if sensor.grid == GRID:
        return sensor
    inside = np.isin(sensor.grid.wavelength_nm, GRID.wavelength_nm)
    if inside.sum() != GRID.n:
        raise InputError(
            f"grid of {sensor.label}",
            f"must contain {GRID}",
            value=sensor.grid,
            found=f"is {sensor.grid}",
            remedy="give its curves as a file",
        )
    return replace(sensor, grid=GRID, qe=sensor.qe[inside])


@kept  # the sensors of a study are the same at each level of light
def entry_of(sensor: Sensor, speeds: tuple[float, ...]) -> LeagueEntry:
    """A sensor without ranks; a camera of the catalog has the pixel of each ISO speed.

    Parameters
    ----------
    sensor
        On the grid of the catalog, or on one that contains 400 to 780 nm in steps of 5 nm.
    speeds
        ISO speeds. [1]

    Raises
    ------
    InputError
        If it has fewer than 3 channels, lacks these wavelengths, or a white has no X, Y or Z.
    """
    cut, facts = _on_grid(sensor), _facts_of(sensor)
    matrix, numbers = _of_filters(cut)
    has_own_peaks = any(OWN_PEAKS in note for note in sensor.notes)
    if has_own_peaks:
        rows = [AtIso(iso=iso, read_noise_e=None) for iso in speeds]
    elif facts is None:
        known = not is_assumed(sensor, "read_noise_e")
        rows = [_at_iso(point_at_iso(cut, iso), iso, matrix, known=known) for iso in speeds]
    else:
        rows = [_of_camera(cut, iso, matrix, facts) for iso in speeds]
    unused = () if facts is None else assumptions(sensor)  # of one ISO speed alone
    is_listed = facts is not None and np.array_equal(
        sensor.qe, sensor_named(facts.name, sensor.grid).qe
    )
    return LeagueEntry(
        name=sensor.label,
        camera=facts.camera if facts is not None and is_listed else "",
        has_own_peaks=has_own_peaks,
        **numbers,
        iso=tuple(rows),
        notes=tuple(note for note in sensor.notes if note not in unused),
        ranks={},
        ties={},
    )


def _facts_of(sensor: Sensor) -> CameraFacts | None:
    """The facts of a camera with the pixel of the catalog, perhaps behind filters."""
    facts = camera_facts().get(sensor.name.partition("+")[0])
    if facts is None or sensor.pixel != sensor_named(facts.name, sensor.grid).pixel:
        return None
    return facts


def _of_camera(sensor: Sensor, iso: float, matrix: ColorMatrix, facts: CameraFacts) -> AtIso:
    if iso < facts.base_iso:
        return AtIso(iso=iso, read_noise_e=None)
    listed = sensor_named(facts.name, sensor.grid)  # a filter changes no pixel
    pixel = camera_pixel(listed, iso)
    there = replace(sensor, pixel=replace(sensor.pixel, **pixel.known))
    known = pixel.read_noise_e is not None
    return _at_iso(point_at_iso(there, iso), iso, matrix, known=known)


DEFAULT_ISO = "100:25600"
MOST_SPEEDS = 32


@lru_cache(maxsize=4)
def _cameras(speeds: tuple[float, ...]) -> tuple[LeagueEntry, ...]:
    """All cameras of the catalog, ranked."""
    entries = [entry_of(sensor_named(name), speeds) for name in camera_facts()]
    return tuple(_ranked(one, entries) for one in entries)


def league_of_study(
    study: Study | None,
    *,
    iso: str | float | Sequence[float] = DEFAULT_ISO,
    by: str = RANKED[0].name,
    given: Given = NOTHING_GIVEN,
) -> "League":
    """The league of the sensors of a study, without one of the cameras alone.

    Parameters
    ----------
    study
        Its sensors take part, with their pixels and filters; all else is that of the league.
    iso, by
        As `chromanoise.league`.
    given
        Objects in place of names.

    Raises
    ------
    InputError
        As `chromanoise.league`.
    """
    speeds, parts = iso_speeds(iso), () if study is None else study.sensors
    if study is not None and (repeated := duplicates(study)):
        raise refusal(repeated)
    sensors = [sensor_of(part, key=f"sensors.{i}", given=given) for i, part in enumerate(parts)]
    return league_of(sensors, speeds=speeds, by=by)


def league_of(
    sensors: Sequence[Sensor], *, speeds: tuple[float, ...] = (), by: str = RANKED[0].name
) -> "League":
    """The league of sensors, without noise where no ISO speed is given.

    Parameters
    ----------
    sensors
        Sensors of one's own, on the grid of the catalog.
    speeds
        ISO speeds. [1]
    by
        As `chromanoise.league`.

    Raises
    ------
    InputError
        As `chromanoise.league`.
    """
    cameras, entries = _cameras(speeds), [entry_of(one, speeds) for one in sensors]
    names = distinct_names([one.name for one in entries])
    own = [replace(one, name=name) for one, name in zip(entries, names, strict=True)]
    order = check.one_of("by", by, [one.name for one in RANKED])
    return League(
        speeds=speeds,
        by=order,
        cameras=tuple(sorted(cameras, key=lambda one: one.ranks.get(order, len(cameras)))),
        sensors=tuple(_ranked(one, cameras) for one in own),
    )


def _ranked(entry: LeagueEntry, cameras: Sequence[LeagueEntry]) -> LeagueEntry:
    ranks, ties = {}, {}
    for one in RANKED:
        if one.of_heights and entry.has_own_peaks:
            continue
        sign = -1.0 if one.more_is_better else 1.0
        others = _others(entry, cameras, one)
        away = [sign * (getattr(camera, one.name) - getattr(entry, one.name)) for camera in others]
        ranks[one.name] = 1 + sum(distance < 0 for distance in away)
        near = zip(others, away, strict=True)
        ties[one.name] = tuple(other.name for other, d in near if abs(d) < one.spread)
    return replace(entry, ranks=ranks, ties=ties)


def _others(entry: LeagueEntry, cameras: Sequence[LeagueEntry], by: Ranked) -> list[LeagueEntry]:
    """The cameras with which an entry is compared."""
    rest = [one for one in cameras if one.camera != entry.camera]
    return [one for one in rest if not (by.of_heights and one.has_own_peaks)]


def _conditions(_: Any) -> str:
    return CONDITIONS


@dataclass(frozen=True, kw_only=True, eq=False)
class League(Result):
    """Cameras and sensors of one's own, by color and noise.

    Attributes
    ----------
    speeds
        ISO speeds. [1]
    by
        The number by which the cameras are sorted.
    cameras
        The cameras of the catalog, the best first.
    sensors
        The sensors of one's own.
    """

    KEYS: ClassVar[JsonKeys] = (
        VERSION,
        JsonKey("conditions", _conditions, text="Light, matrix, range and area."),
        *("speeds", "by", "cameras", "sensors"),
    )

    speeds: tuple[float, ...]
    by: str
    cameras: tuple[LeagueEntry, ...]
    sensors: tuple[LeagueEntry, ...]

    @property
    def sentences(self) -> tuple[str, ...]:
        """Where each sensor of one's own stands; without one, the best cameras."""
        if self.sensors:
            return tuple(map(self.place, self.sensors))
        return tuple(map(self._best, RANKED[:2]))

    def place(self, entry: LeagueEntry) -> str:
        """Loss and color error of a sensor, and how many other cameras have more, in a sentence."""
        parts = []
        for one in RANKED[:2]:
            value = f"{one.label} {entry.with_unit(one)}"
            parts.append(value + self._among(entry, one))
        return f"{entry.name}: {'; '.join(parts)}."

    def _among(self, entry: LeagueEntry, by: Ranked) -> str:
        if by.name not in entry.ranks:
            return " (without a rank, because each channel is divided by its own peak)"
        others = _others(entry, self.cameras, by)
        ties, value = len(entry.ties[by.name]), getattr(entry, by.name)
        lower = sum(getattr(one, by.name) >= value + by.spread for one in others)
        higher = len(others) - lower - ties
        count = f"{len(others)} {'other ' if entry.camera else ''}cameras"
        if lower == len(others):
            return f", lower than all {count}"
        if higher == len(others):
            return f", higher than all {count}"
        parts = (f"lower than {lower}", f"tied with {ties}", f"higher than {higher}")
        counted = [part for part, n in zip(parts, (lower, ties, higher), strict=True) if n]
        return f", {', '.join(counted)} of {count}"

    def _best(self, one: Ranked) -> str:
        best = min(self.cameras, key=lambda camera: camera.ranks.get(one.name, len(self.cameras)))
        tied = best.ties[one.name]
        with_ties = f", tied with {_first_names(tied)}" if tied else ""
        return f"{best.name} has the lowest {one.label} ({best.with_unit(one)}{with_ties})."

    def to_table(self) -> Table:
        """One row per sensor and camera; visual noise at each ISO speed."""
        return self._table(RANKED, range(len(self.speeds)))

    def short_table(self, most: int) -> Table:
        """`to_table` with the ranks by ``by`` alone, and few ISO speeds.

        Parameters
        ----------
        most
            Largest number of ISO speeds, evenly spread, at least 1.

        Returns
        -------
        Table
            One row per sensor and camera.
        """
        spread = np.linspace(0, len(self.speeds) - 1, most) if self.speeds else ()
        speeds = sorted({round(i) for i in spread})
        return self._table([one for one in RANKED if one.name == self.by], speeds)

    def _table(self, ranked: Sequence[Ranked], speeds: Sequence[int]) -> Table:
        return table_of(
            "League of cameras",
            (*self.sensors, *self.cameras),
            ("name", "", "", lambda entry: entry.name),
            *(
                (f"rank by {one.label}", "", "", partial(LeagueEntry.rank, by=one))
                for one in ranked
            ),
            *((one.label, one.unit, one.digits, attrgetter(one.name)) for one in RANKED),
            *(
                (f"visual noise at ISO {self.speeds[i]:g}", "", ".2f", partial(_noise, speed=i))
                for i in speeds
            ),
            notes=(CONDITIONS,),
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw color error against color SNR loss, one point per camera and sensor."""
        return figures().draw_league(self, axes_of(ax))

    def __repr__(self) -> str:
        return f"<League: {len(self.cameras)} cameras, {len(self.sensors)} sensors>"

    def _repr_html_(self) -> str:
        return self._html(" ".join(self.sentences), (CONDITIONS,))


def _noise(entry: LeagueEntry, speed: int) -> float | str | None:
    at = entry.iso[speed]
    return "saturated" if at.saturated else at.visual_noise


def _first_names(names: Sequence[str], most: int = 3) -> str:
    if len(names) <= most:
        return ", ".join(names)
    return f"{', '.join(names[:most])} and {len(names) - most} more"


def iso_speeds(given: str | float | Sequence[float]) -> tuple[float, ...]:
    """ISO speeds of a text, a number or several numbers.

    Parameters
    ----------
    given
        ``100:25600`` for whole stops from the first to the last, ``100,160,400``, or numbers.

    Raises
    ------
    InputError
        If it is not such a text, or a speed is not between 1 and 1e7, or they do not rise.

    Examples
    --------
    >>> iso_speeds("100:1600")
    (100.0, 200.0, 400.0, 800.0, 1600.0)
    """
    if isinstance(given, str) and ":" in given:
        if given.count(":") > 1:
            need = "must have the form FIRST:LAST"
            raise InputError("iso", need, value=given, remedy=f"write {DEFAULT_ISO}")
        first, last = map(_speed, given.split(":"))
        stops = round(log2(last / first))
        speeds = [first * 2**i for i in range(stops + 1)]
        if not isclose(first * 2.0**stops, last, rel_tol=1e-9):
            whole = f"{first:g}:{first * 2 ** max(1, stops):g}"
            raise InputError("iso", "must span whole stops", value=given, remedy=f"write {whole}")
    elif isinstance(given, str):
        speeds = [_speed(part) for part in given.split(",")]
    else:
        speeds = [_speed(one) for one in np.ravel(np.asarray(given)).tolist()]
    if sorted(set(speeds)) != speeds or not 1 <= len(speeds) <= MOST_SPEEDS:
        raise InputError(
            "iso",
            f"must rise, and have 1 to {MOST_SPEEDS} values",
            value=given,
            remedy=f"write {DEFAULT_ISO} or 100,200,400",
        )
    return tuple(speeds)


def _speed(given: str | float) -> float:
    need = f"must be ISO speeds, as {DEFAULT_ISO} or 100,200,400"
    return check.within("iso", "1", check.number(str(given), "iso", need), 1.0, 1e7)
