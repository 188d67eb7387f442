"""The cameras of the catalog and further sensors, ranked at equal light on equal area."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from math import isclose, log2
from typing import Any, ClassVar

import numpy as np

from chromanoise.base import (
    VERSION,
    InputError,
    JsonKey,
    JsonKeys,
    check,
    dataclass,
    from_above,
)
from chromanoise.io import Column, Result, Table, axes_of
from chromanoise.sensor import Sensor
from chromanoise.spectra.tables import camera_facts
from chromanoise.study.assembly import NOTHING_GIVEN, Given, sensor_of
from chromanoise.study.catalog import sensor_named
from chromanoise.study.league_entries import (
    CONDITIONS,
    RANKED,
    AtIso,
    LeagueEntry,
    Ranked,
    entry_of,
)
from chromanoise.study.schema import Study

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
    cameras, own = _cameras(speeds), [entry_of(one, speeds) for one in sensors]
    check.distinct("sensors", [one.name for one in own])
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
        with_ties = f", tied with {_listed(tied)}" if tied else ""
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
        ranks = [Column(name=f"rank by {one.label}") for one in ranked]
        numbers = [Column(name=one.label, unit=one.unit, digits=one.digits) for one in RANKED]
        noise = [
            Column(name=f"visual noise at ISO {self.speeds[i]:g}", digits=".2f") for i in speeds
        ]
        rows = tuple(
            (
                entry.name,
                *(entry.rank(one) for one in ranked),
                *(getattr(entry, one.name) for one in RANKED),
                *(_noise(entry.iso[i]) for i in speeds),
            )
            for entry in (*self.sensors, *self.cameras)
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


def _two(given: str) -> list[str]:
    parts = given.split(":")
    if len(parts) != 2:
        need = "must have the form FIRST:LAST"
        raise InputError("iso", need, value=given, remedy=f"write {DEFAULT_ISO}")
    return parts


def _speed(given: str | float) -> float:
    need = f"must be ISO speeds, as {DEFAULT_ISO} or 100,200,400"
    return check.within("iso", "1", check.number(str(given), "iso", need), 1.0, 1e7)
