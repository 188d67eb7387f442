"""Color error against color SNR loss: a point per measured camera, and the sensors among them."""

from collections.abc import Sequence
from functools import partial

from chromanoise.base import InputError
from chromanoise.charts.charted_study import Look, Shown
from chromanoise.charts.description import Axis, Chart, Cloud, Column, Mark, Panel, Point, column
from chromanoise.charts.numbers import decimal
from chromanoise.study import OF_FILTERS, RANKED, League, LeagueEntry, Ranked, league_of

_ROOM = 0.05  # of an axis, beyond its last points


def drawn_league(shown: Shown, look: Look) -> Chart:
    """The cameras of the catalog, and the sensors of the study with their filters among them.

    Light, matrix and training set are those of the league and not of the study. A sensor that
    cannot take part is named with the reason.
    """
    names, standings, why = [], [], []
    for sensor in (point.sensor for point in shown.operating_points):
        names.append(sensor.label)
        try:
            standings.append(league_of([sensor]).sensors[0])
        except InputError as error:
            why.append(f"{error}.")
    return league_chart(names, league_of([]), standings, why)


def league_chart(
    names: Sequence[str], league: League, standings: Sequence[LeagueEntry], why: Sequence[str]
) -> Chart:
    """The chart of a league: all cameras, and its sensors among them.

    Parameters
    ----------
    names
        Names of all sensors that have a color, also of those without a place.
    standings
        The sensors that are drawn.
    why
        Sentences on those that are not.
    """
    cameras = [one for one in league.cameras if not one.has_own_peaks]
    rows, count = (*cameras, *standings), len(cameras)
    across, up, *_ = RANKED
    marks: list[Mark] = [
        Cloud(x=2, y=3, first=0, last=count, name=f"{count} cameras"),
        *(
            Point(x=2, y=3, row=count + k, text=one.name, sensor=names.index(one.name))
            for k, one in enumerate(standings)
        ),
    ]
    axes = [
        Axis(
            label=f"{one.label} [{one.unit.replace('Delta E', 'ΔE')}]",
            low=min(values) - _ROOM * (max(values) - min(values)),
            high=max(values) + _ROOM * (max(values) - min(values)),
        )
        for one in (across, up)
        if (values := [getattr(row, one.name) for row in rows])
    ]
    sentences = tuple(map(league.place, standings))
    return Chart(
        title="Color error against color SNR loss",
        description=" ".join(sentences) or f"The color errors of {count} cameras.",
        sensors=tuple(names),
        columns=(
            column("sensor", [one.name for one in rows]),
            column("camera", [one.camera or "of this study" for one in rows]),
            *(
                _column(f"{one.label} [{one.unit}]".removesuffix(" []"), rows, one)
                for one in RANKED
            ),
        ),
        panels=(Panel(x=axes[0], y=axes[1], marks=tuple(marks), better="\u2199"),),
        whole_rows=True,
        notes=(*sentences, *why, f"{OF_FILTERS[:1].upper()}{OF_FILTERS[1:]}."),
    )


def _column(head: str, rows: Sequence[LeagueEntry], ranked: Ranked) -> Column:
    number = partial(decimal, digits=int(ranked.digits[1]))
    return column(head, [getattr(one, ranked.name) for one in rows], number)
