"""The cameras of the catalog and further sensors at equal light on equal area.

Everything is seen in D50 with the white-preserving matrix of the 190 patches of rawtoaces. Color
SNR loss, color error, SMI and the colors at equal saturation depend on the filters alone. At an ISO
speed S, an 18 % gray has the exposure 10 / S lx s on the sensor (ISO 12232:2019), and all noise is
that of the pixels of one area, so that neither the lens nor the size of the pixels decides.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from math import floor, log2, sqrt
from pathlib import Path
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
    from_above,
)
from chromanoise.color import (
    ColorMatrix,
    Training,
    colored,
    training_color_error,
    white_preserving,
)
from chromanoise.io import Column, Result, Table, axes_of
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
from chromanoise.spectra.tables import camera_facts, packaged_table
from chromanoise.study.analysis import electrons_at
from chromanoise.study.cameras import AT_THE_SENSOR, GRAY_LUX_S, camera_pixel
from chromanoise.study.color_noise import GRAY, Viewing, noise_as_viewed
from chromanoise.study.resolve_names import resolve_sensor

DEFAULT_ISO = "100:25600"
MOST_SPEEDS = 32
GRID = Grid.uniform(400, 780, 5)
"""The curves of the cameras and the training set end at 780 nm; those of other sensors are cut."""
LIGHT = "D50"
TRAINING = "patches-190"
SIDE_UM = 4.0
"""Side of the area whose pixels are summed. [um]"""
SATURATION_E = 10_000.0
"""Electrons of a white in the fullest channel, at equal saturation. [e-]"""
BLOCKS_NM = ((400.0, 485.0), (490.0, 575.0), (580.0, 700.0))
"""Each distinguishable color is a reflectance that is constant on these. [nm]"""
_NODES = 12  # agrees with 20 to 0.001 bit
_SHUTTER_S = 0.01  # of all exposures; it decides on dark current alone


@dataclass(frozen=True, slots=True, kw_only=True)
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
    spread
        Root mean square of the differences between two measurements of one camera, over six
        cameras that another laboratory measured too: those that differ by less tie.
    """

    name: str
    label: str
    unit: str
    digits: str
    more_is_better: bool
    spread: float


RANKED = (
    Ranked(
        name="color_snr_loss_db",
        label="color SNR loss",
        unit="dB",
        digits=".2f",
        more_is_better=False,
        spread=0.19,
    ),
    Ranked(
        name="color_error",
        label="color error",
        unit="Delta E*ab",
        digits=".2f",
        more_is_better=False,
        spread=0.34,
    ),
    Ranked(name="smi", label="SMI", unit="", digits=".1f", more_is_better=True, spread=1.1),
    Ranked(
        name="colors_bits",
        label="colors",
        unit="bit",
        digits=".2f",
        more_is_better=True,
        spread=0.14,
    ),
)
"""What depends on the filters alone; the first decides the order of the table."""


@dataclass(frozen=True, slots=True, kw_only=True)
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
        Colors up to the white that the best reader tells apart. [bit]
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


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LeagueEntry:
    """One sensor of a league.

    Attributes
    ----------
    name
        The name in the catalog, or the label of a sensor of one's own.
    camera
        Maker and model; empty for a sensor of one's own.
    color_snr_loss_db
        SNR of the best linear readout of a white minus that of Y, for shot noise alone. [dB]
    color_error
        Mean color error over the 190 patches. [Delta E*ab]
    smi
        Sensitivity metamerism index of ISO 17321-1. [1]
    colors_bits
        Colors that the best reader tells apart at equal saturation, for shot noise alone. [bit]
    ranks
        Rank of each of these among the cameras, 1 for the best.
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
        *("ranks", "ties", "iso", "notes"),
    )

    name: str
    camera: str
    color_snr_loss_db: float
    color_error: float
    smi: float
    colors_bits: float
    iso: tuple[AtIso, ...]
    notes: tuple[str, ...]
    ranks: Mapping[str, int]
    ties: Mapping[str, tuple[str, ...]]

    def rank(self, by: Ranked) -> str:
        """The rank by a number, with ``=`` where it is shared within the spread."""
        return f"{self.ranks[by.name]}{'=' if self.ties[by.name] else ''}"


OF_FILTERS = (
    f"light {LIGHT}; white-preserving matrix of the 190 training patches of rawtoaces; "
    f"{GRID.wavelength_nm[0]:g} to {GRID.wavelength_nm[-1]:g} nm"
)
"""What the numbers of filters hold for."""
CONDITIONS = (
    f"{OF_FILTERS}; noise of {SIDE_UM:g} x {SIDE_UM:g} um, 18 % gray at {GRAY_LUX_S:g}/ISO lx s on "
    "the sensor; = marks a tie within the spread of two measurements of one camera"
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


@dataclass(frozen=True, slots=True, kw_only=True)
class _OfFilters:
    """What depends on the filters of a sensor alone."""

    matrix: ColorMatrix
    color_snr_loss_db: float
    color_error: float
    smi: float
    colors_bits: float


def _of_filters(sensor: Sensor) -> _OfFilters:
    """At equal saturation, for shot noise alone."""
    quiet = replace(
        sensor,
        pixel=Pixel(pitch_um=SIDE_UM, full_well_e=SATURATION_E, read_noise_e=0.0),
        converter=UNKNOWN_CONVERTER,
    )
    dim = OperatingPoint(sensor=quiet, exposure=AT_THE_SENSOR, illuminant=_light(), level_lux=1.0)
    point = replace(dim, level_lux=SATURATION_E / float(electrons_at(dim).max()))
    seen = (quiet, point.exposure, _training())
    matrix = white_preserving(*seen, level_lux=point.level_lux)
    raw = with_noise(electrons_at(point), quiet, point.exposure)
    error = training_color_error(*seen, matrix, level_lux=point.level_lux)
    if error is None:
        raise InputError(sensor.name, "must have X, Y and Z of a white above 0", value=None)
    return _OfFilters(
        matrix=matrix,
        color_snr_loss_db=float(color_snr_loss_db(raw, colored(raw, matrix))),
        color_error=error,
        smi=sensor_metamerism(quiet).index,
        colors_bits=distinguishable_colors_bits(_blocks_e(point), read_noise_e=0.0),
    )


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
    viewed = noise_as_viewed(white_e, sensor, exposure, matrix.matrix, Viewing())
    best, of_matrix = (
        distinguishable_colors_bits(blocks_e, matrix=reader, nodes=_NODES, **dark)
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
    return replace(sensor, grid=GRID, qe=sensor.qe[inside])


@lru_cache(maxsize=4)
def _cameras(speeds: tuple[float, ...]) -> tuple[LeagueEntry, ...]:
    """All cameras of the catalog, without ranks."""
    return tuple(_camera(name, facts.camera, speeds) for name, facts in camera_facts().items())


def _camera(name: str, camera: str, speeds: tuple[float, ...]) -> LeagueEntry:
    sensor = _on_grid(resolve_sensor(name))
    filters = _of_filters(sensor)
    rows = []
    for iso in speeds:
        if iso < camera_facts()[name].base_iso:
            rows.append(AtIso(iso=iso, read_noise_e=None))
            continue
        pixel = camera_pixel(sensor, iso)
        known = "read_noise_e" in pixel
        there = replace(sensor, pixel=replace(sensor.pixel, **pixel))
        rows.append(_at_iso(point_at_iso(there, iso), iso, filters.matrix, known=known))
    return _standing(sensor, camera, filters, rows)


def _own(given: Sensor, speeds: tuple[float, ...]) -> LeagueEntry:
    sensor = _on_grid(given)
    filters = _of_filters(sensor)
    rows = [_at_iso(point_at_iso(sensor, iso), iso, filters.matrix, known=True) for iso in speeds]
    return _standing(sensor, "", filters, rows)


def _standing(
    sensor: Sensor, camera: str, filters: _OfFilters, rows: Sequence[AtIso]
) -> LeagueEntry:
    return LeagueEntry(
        name=sensor.label,
        camera=camera,
        **{one.name: getattr(filters, one.name) for one in RANKED},
        iso=tuple(rows),
        notes=sensor.notes,
        ranks={},
        ties={},
    )


def league(
    *sensors: str | Path | Sensor,
    iso: str | float | Sequence[float] = DEFAULT_ISO,
    by: str = RANKED[0].name,
) -> "League":
    """The cameras of the catalog, and sensors of one's own among them, by color and noise.

    Parameters
    ----------
    sensors
        Sensors of one's own: catalog names, files of quantum efficiency, or `Sensor` objects, with
        3 channels or more. Their curves count from 400 to 780 nm.
    iso
        ISO speeds: ``100:25600`` in whole stops, ``100,400``, or numbers.
    by
        The number by which the cameras are sorted, the best first: ``color_snr_loss_db``,
        ``color_error``, ``smi`` or ``colors_bits``.

    Returns
    -------
    League
        Standings from the least to the largest color SNR loss.

    Raises
    ------
    InputError
        If a sensor cannot be read or has fewer than 3 channels, or a speed is out of range.

    Notes
    -----
    Exposures per ISO speed are those of ISO 12232 (2019), SMI is that of ISO 17321-1 (2012), visual
    noise that of ISO 15739 (2017). The colors are those of
    `chromanoise.metrics.distinguishable_colors_bits`.

    Examples
    --------
    >>> import chromanoise as cn
    >>> best = cn.league(iso=800).cameras[0]
    >>> best.name, round(best.color_snr_loss_db, 2)
    ('canon-eos-1ds-mark-iii', 2.57)
    """
    speeds = iso_speeds(iso)
    words = [one if isinstance(one, Sensor) else str(one) for one in sensors]
    given = [
        one if isinstance(one, Sensor) or one in camera_facts() else resolve_sensor(one)
        for one in words
    ]
    return league_of(given, speeds=speeds, by=by)


def league_of(
    sensors: Sequence[Sensor | str], *, speeds: tuple[float, ...] = (), by: str = RANKED[0].name
) -> "League":
    """`league` of sensors, without noise where no ISO speed is given.

    Parameters
    ----------
    sensors
        Sensors of one's own, on the grid of the catalog, or names of cameras.
    speeds
        ISO speeds. [1]
    by
        As `league`.

    Raises
    ------
    InputError
        As `league`.
    """
    cameras = _cameras(speeds)
    by_name = {one.name: one for one in cameras}
    own = [by_name[one] if isinstance(one, str) else _own(one, speeds) for one in sensors]
    check.distinct("sensors", [one.name for one in own])
    order = check.one_of("by", by, [one.name for one in RANKED])
    ranked = [_ranked(one, cameras) for one in cameras]
    return League(
        speeds=speeds,
        by=order,
        cameras=tuple(sorted(ranked, key=lambda one: one.ranks[order])),
        sensors=tuple(_ranked(one, cameras) for one in own),
    )


def _ranked(standing: LeagueEntry, cameras: Sequence[LeagueEntry]) -> LeagueEntry:
    ranks, ties = {}, {}
    for one in RANKED:
        sign = -1.0 if one.more_is_better else 1.0
        own = getattr(standing, one.name)
        others = [camera for camera in cameras if camera.name != standing.name]
        away = [sign * (getattr(camera, one.name) - own) for camera in others]
        ranks[one.name] = 1 + sum(distance < 0 for distance in away)
        near = zip(others, away, strict=True)
        ties[one.name] = tuple(other.name for other, d in near if abs(d) < one.spread)
    return replace(standing, ranks=ranks, ties=ties)


def _conditions(_: Any) -> str:
    return CONDITIONS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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
        return (*(self._best(one) for one in RANKED[:2]), *self._quietest())

    def place(self, standing: LeagueEntry) -> str:
        """Loss and color error of a sensor, and how many cameras have more, in a sentence."""
        parts = []
        for one in RANKED[:2]:
            unit = one.unit.replace("Delta E", "ΔE")
            value = f"{format(getattr(standing, one.name), one.digits)} {unit}"
            parts.append(f"{one.label} {value}, {self._worse(standing.ranks[one.name])}")
        return f"{standing.name}: {'; '.join(parts)}."

    def _worse(self, rank: int) -> str:
        """Than how many cameras a sensor of this rank has less of what is better low."""
        count, better = len(self.cameras), rank - 1
        if better == count:
            return f"more than all {count} cameras"
        if better == 0:
            return f"less than all {count} cameras"
        return f"less than {count - better} of {count} cameras"

    def _best(self, one: Ranked) -> str:
        best = min(self.cameras, key=lambda camera: camera.ranks[one.name])
        tied = best.ties[one.name]
        value = format(getattr(best, one.name), one.digits)
        unit = one.unit.replace("Delta E", "ΔE")
        with_ties = f", tied with {_listed(tied)}" if tied else ""
        most = "largest" if one.more_is_better else "least"
        return f"{best.name} has the {most} {one.label} ({value} {unit}{with_ties})."

    def _quietest(self) -> tuple[str, ...]:
        """The camera of least visual noise at the middle speed where any is known."""
        if not self.speeds:
            return ()
        i = len(self.speeds) // 2
        known = [camera for camera in self.cameras if camera.iso[i].visual_noise is not None]
        if not known:
            return ()
        best = min(known, key=lambda camera: camera.iso[i].visual_noise or 0.0)
        return (
            f"At ISO {self.speeds[i]:g}, equal light and equal area, {best.name} has the least "
            f"visual noise of the {len(known)} cameras with known read noise "
            f"({best.iso[i].visual_noise:.2f}).",
        )

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
        last = len(self.speeds) - 1
        speeds = sorted({round(i) for i in np.linspace(0, last, most)})
        return self._table([one for one in RANKED if one.name == self.by], speeds)

    def _table(self, ranked: Sequence[Ranked], speeds: Sequence[int]) -> Table:
        ranks = [Column(name=f"rank by {one.label}") for one in ranked]
        numbers = [Column(name=one.label, unit=one.unit, digits=one.digits) for one in RANKED]
        noise = [Column(name=f"noise at ISO {self.speeds[i]:g}", digits=".2f") for i in speeds]
        rows = tuple(
            (
                standing.name,
                *(standing.rank(one) for one in ranked),
                *(getattr(standing, one.name) for one in RANKED),
                *(_noise(standing.iso[i]) for i in speeds),
            )
            for standing in (*self.sensors, *self.cameras)
        )
        return Table(
            title="League of cameras",
            columns=(Column(name="name"), *ranks, *numbers, *noise),
            rows=rows,
            notes=(CONDITIONS,),
        )

    def plot(self, ax: Any = None) -> Any:
        """Draw color error against color SNR loss, one point per camera and sensor."""
        return from_above("figures").draw_league(self, axes_of(ax))

    def __repr__(self) -> str:
        return f"<League: {len(self.cameras)} cameras, {len(self.sensors)} sensors>"

    def _repr_html_(self) -> str:
        return self._html(" ".join(self.sentences), (CONDITIONS,))


def _noise(at: AtIso) -> float | str | None:
    return "saturated" if at.saturated else at.visual_noise


def _listed(names: Sequence[str], most: int = 3) -> str:
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
        first, last = (_speed(part) for part in _two(given))
        stops = log2(last / first)
        speeds = [first * 2**i for i in range(floor(stops + 1e-9) + 1)]
    elif isinstance(given, str):
        speeds = [_speed(part) for part in given.split(",")]
    else:
        speeds = [_speed(one) for one in ([given] if isinstance(given, int | float) else given)]
    if sorted(set(speeds)) != speeds or not 1 <= len(speeds) <= MOST_SPEEDS:
        raise InputError(
            "iso",
            f"must rise, and have 1 to {MOST_SPEEDS} values",
            value=given,
            remedy=f"write {DEFAULT_ISO} or 100,200,400",
        )
    return tuple(speeds)


def _two(given: str) -> list[str]:
    parts = given.split(":")
    if len(parts) != 2:
        need = "must have the form FIRST:LAST"
        raise InputError("iso", need, value=given, remedy=f"write {DEFAULT_ISO}")
    return parts


def _speed(given: str | float) -> float:
    need = "must be ISO speeds"
    return check.within("iso", "1", check.number(str(given), "iso", need), 1.0, 1e7)
