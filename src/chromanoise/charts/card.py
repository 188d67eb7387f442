"""A card: one sheet that compares sensors, for slides and paper.

Verdict, quantum efficiency, SNR over the light level, budgets, pictures, color error of the
patches, and a line of settings. Every text is at least 9 pt, so that it is read at 960 pixels.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from html import escape
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.font_manager import FontProperties
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.text import Annotation, Text
from matplotlib.textpath import TextToPath
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Bbox

from chromanoise.base import Array, InputError, UInt8, __version__, check, dataclass, write_whole
from chromanoise.charts.budget_chart import budget_of
from chromanoise.charts.charted_study import MOST_ON_CARD, Look, Shown, saturation_sentence
from chromanoise.charts.color_checker import drawn_chart
from chromanoise.charts.description import Chart
from chromanoise.charts.figure_marks import draw_panel, draw_waterfalls, rows_of_waterfalls
from chromanoise.charts.figure_style import (
    QUIET,
    are_many,
    chromanoise_style,
    figure_bytes,
    sensor_dashes,
    sensor_lines,
    sensor_mark,
    write_sensor,
)
from chromanoise.charts.levels import curves_chart, drawn_lux
from chromanoise.charts.numbers import NONE, brief, decimal, listed, signed
from chromanoise.charts.result_figures import draw_picture
from chromanoise.charts.sensitivities import sensitivities_chart
from chromanoise.charts.verdicts import matrices_in_words, verdict_of
from chromanoise.imaging import Work, camera_for
from chromanoise.imaging.denoising import captured_with
from chromanoise.noise import conditions, level_in_words, saturated
from chromanoise.spectra import checker_cube, is_extrapolation_note, row_source
from chromanoise.study import (
    QUANTITIES,
    Analysis,
    PicturePart,
    Verdict,
    capture_settings_of,
    color_snr_db,
    compared,
    electrons_at,
    fullest_level_lux,
    is_assumed,
    mean_color_error,
    visual_noise_of,
)

Paper = Literal["16:9", "a4"]
"""A slide of 13.33 x 7.5 in, or A4 across."""
PAPERS_IN: Mapping[Paper, tuple[float, float]] = {"16:9": (40 / 3, 7.5), "a4": (11.693, 8.268)}
ENDINGS = ("pdf", "svg", "png", "html")
_SMALLEST_PT = 9.0
_NOT_ON_CARD = frozenset({"turns", "matrix order"})  # of the sentences that answer the reader
_PIXELS = 1920  # across
_EDGE_IN = 0.14
_PLACES = 5  # of a place, as a share of the figure
_BUDGET, _GAIN = "budget", "gain"  # labels of axes with gains, and of each gain
_GAP_EM = 0.5  # before a gain
_BEYOND = 3.0  # of the highest saturation, to the end of the axis
_MOST_BUDGETS = 3
_SHOWN = 2  # sensors with a picture; of more than three, also with a budget
_MOST_WITH_GAINS = 2
# blue, green and red, and white and two grays below them
_ROWS, _COLUMNS = (152, 316), slice(0, 240)
_NAME_LETTERS = 22
_LETTER_IN, _AXIS_IN = 0.0095, 0.35  # of a title per pt, and beside the axes
_FEWEST_LETTERS = 10


@dataclass(frozen=True, kw_only=True, eq=False)
class Card:
    """One sheet that compares sensors: `figure` draws it, `save` writes it.

    Attributes
    ----------
    of
        The study with its results.
    verdict
        Its verdict; the card shows the sentences that answer its reader, but where the order turns.
    shown
        Indices of the sensors with a picture: the first two by the verdict.
    pictures
        The same crop of a picture through each of them; ``None`` where a channel is saturated on
        the white. [8-bit sRGB]
    paper
        Size of the sheet.
    """

    of: Shown
    verdict: Verdict
    shown: tuple[int, ...]
    pictures: tuple[UInt8[Array, "h w 3"] | None, ...]
    paper: Paper

    def __post_init__(self) -> None:
        check.same_length("pictures", shown=len(self.shown), pictures=len(self.pictures))

    @property
    def title(self) -> str:
        """The sensors, the light and the exposure."""
        return f"{listed(_names(self.of))} at {conditions(self.of.operating_points)}"

    @property
    def sentences(self) -> tuple[str, ...]:
        """Those of the verdict that are on the card."""
        return tuple(one.text for one in self.verdict.answer if one.about not in _NOT_ON_CARD)

    @property
    def footer(self) -> str:
        """Pixel of each sensor, origin of its curves, light, matrix, prior and version."""
        pixels: dict[str, list[str]] = {}
        for point in self.of.operating_points:
            one = point.sensor.pixel
            values = {
                "pitch_um": f"{brief(one.pitch_um)} µm",
                "full_well_e": f"full well {decimal(one.full_well_e, 0)} e⁻",
                "read_noise_e": f"read noise {brief(one.read_noise_e)} e⁻",
            }
            text = ", ".join(
                f"{value} (assumed)" if is_assumed(point.sensor, name) else value
                for name, value in values.items()
            )
            if point.sensor.origin in ("reconstruction", "model"):
                text += f", curves: {point.sensor.origin}"
            text += "".join(f", {one}" for one in point.sensor.notes if is_extrapolation_note(one))
            pixels.setdefault(text, []).append(point.sensor.label)
        alike = len(pixels) == 1
        each = [f"{'pixel' if alike else f'{listed(who)}:'} {text}" for text, who in pixels.items()]
        prior = Path(self.of.study.prior.removeprefix("object:")).name
        settings = (
            conditions(self.of.operating_points),
            f"matrix {matrices_in_words(self.of.analyses)}, prior {prior}",
            f"chromanoise {__version__}",
        )
        return "; ".join([*each, *settings])

    def figure(self) -> Figure:
        """The sheet as a figure of Matplotlib."""
        with chromanoise_style(), _without_formulas():
            return _drawn(self)

    def content(self, ending: str) -> bytes:
        """The bytes of its file.

        Parameters
        ----------
        ending
            ``pdf``, ``svg``, ``png`` (1920 pixels across) or ``html``.

        Raises
        ------
        InputError
            If the ending is another.
        """
        check.one_of("format of a card", ending, ENDINGS)
        dpi = math.ceil(_PIXELS / PAPERS_IN[self.paper][0])
        with _without_formulas():
            written = figure_bytes(self.figure(), "svg" if ending == "html" else ending, dpi=dpi)
        if ending != "html":
            return written
        own = written[written.index(b"<svg") :].decode("utf-8")
        return _PAGE.format(title=escape(self.title), svg=own).encode("utf-8")

    def save(self, file: str | Path) -> None:
        """Write it; the ending of the file says how.

        Parameters
        ----------
        file
            Ends in ``.pdf``, ``.svg``, ``.png`` or ``.html``; an existing file is replaced.

        Raises
        ------
        InputError
            If the ending is another, or the file cannot be written.
        """
        write_whole(Path(file), self.content(card_ending(file)))


_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>body {{ margin: 0 }} svg {{ width: 100%; height: auto }} \
@page {{ size: landscape; margin: 0 }}</style>
</head>
<body>
{svg}</body>
</html>
"""


def card_ending(file: str | Path) -> str:
    """The format of a card by the name of its file.

    Raises
    ------
    InputError
        If there is no such format.

    Examples
    --------
    >>> card_ending("slides/card.PDF")
    'pdf'
    """
    ending = Path(file).suffix.lower().removeprefix(".")
    if ending not in ENDINGS:
        demand = f"must end in {', '.join(f'.{one}' for one in ENDINGS[:-1])} or .{ENDINGS[-1]}"
        raise InputError("file", demand, value=str(file))
    return ending


def card_of(of: Shown, *, paper: Paper = "16:9", work: Work | None = None) -> Card:
    """The card of a study.

    Parameters
    ----------
    of
        The study with its results.
    paper
        Size of the sheet.
    work
        Threads of the pictures.

    Raises
    ------
    InputError
        If the study has more sensors than a card, or a result cannot be computed.
    """
    check.one_of("paper", paper, tuple(PAPERS_IN))
    count = len(of.operating_points)
    if count > MOST_ON_CARD:
        raise InputError(
            "sensors", f"must be at most {MOST_ON_CARD} on a card", value=count, setting="sensors"
        )
    study, maker = of.study, next(iter(of.makers.values()))
    verdict = verdict_of(
        of.analyses,
        equal=study.exposure.equal,
        reader=study.outputs.reader,
        prior=maker.prior,
    )
    shown = tuple(sorted(_ranked(of, verdict)[:_SHOWN]))
    cube = checker_cube()
    crop = replace(cube, stored=row_source(cube.stored).rows(*_ROWS)[:, _COLUMNS])
    settings = capture_settings_of(PicturePart(cube=cube.source, clip=True), seed=study.seed)
    pictures: list[UInt8[Array, "h w 3"] | None] = []
    for i in shown:
        point = of.operating_points[i]
        if saturated(electrons_at(point), point.sensor, point.exposure).any():
            pictures.append(None)
            continue
        camera = camera_for(crop, point, of.analyses[i].matrix, settings)
        taken = captured_with(crop, camera, None, frame=0, work=work or Work()).picture
        assert taken is not None  # these settings ask for color
        pictures.append(taken.srgb)
    return Card(of=of, verdict=verdict, shown=shown, pictures=tuple(pictures), paper=paper)


def _names(of: Shown) -> list[str]:
    return [one.sensor.label for one in of.analyses]


def _ranked(of: Shown, verdict: Verdict) -> list[int]:
    """The sensors from best to worst: by the verdict, then by their SNR of Y."""
    names = [one.name for one in verdict.at_equal_color.standings]
    names = list(dict.fromkeys([*filter(None, [verdict.winner]), *names]))  # of a machine, too

    def place(i: int) -> tuple[int, float]:
        name, snr = of.analyses[i].sensor.name, color_snr_db(of.analyses[i])["Y"]
        rank = names.index(name) if name in names else len(names)
        return rank, -(-math.inf if snr is None else snr)

    return sorted(range(len(of.analyses)), key=place)


def _without_formulas() -> Any:
    """A dollar sign in a name is no formula."""
    import matplotlib

    return matplotlib.rc_context({"text.parse_math": False})


def _drawn(card: Card) -> Figure:
    of, (wide_in, high_in) = card.of, PAPERS_IN[card.paper]
    text_pt = 72 * (wide_in - 2 * _EDGE_IN)
    head = _head(card, text_pt)
    foot = list(_lines(card.footer, _SMALLEST_PT, text_pt))
    rows = 1 + len(of.analyses)
    heights = {
        "head": sum(1.25 * size for _, size, _ in head) / 72 + _EDGE_IN,
        "strip": 0.3 + 0.215 * rows,
        "foot": 1.3 * _SMALLEST_PT * len(foot) / 72 + _EDGE_IN,
    }
    rest = high_in - sum(heights.values())
    engine = ConstrainedLayoutEngine(w_pad=_EDGE_IN, h_pad=0.06, wspace=0.0, hspace=0.0)
    figure = Figure(figsize=(wide_in, high_in), layout=engine)
    count, many = len(of.analyses), are_many(_names(of))
    share = 0.38 if many else 0.48
    ratios = [heights["head"], share * rest, (1 - share) * rest, heights["strip"], heights["foot"]]
    above, first, second, strip, below = _parts(figure, 5, 1, height_ratios=ratios)
    _write_lines(above, head, wide_in, heights["head"])
    if many:  # a row of curves for itself
        curves = first
        levels, budgets, pictures = _parts(second, 1, 3, width_ratios=(1.0, 1.15, 0.43))
    else:
        curves, levels = _parts(first, 1, 2, width_ratios=(0.45 + 0.15 * count, 1.0))
        widths = (wide_in / high_in - 0.5, 0.48 * len(card.shown))
        budgets, pictures = _parts(second, 1, 2, width_ratios=widths)
    _draw_sensitivities(card, curves)
    _draw_levels(card, levels)
    _draw_budgets(card, budgets)
    _draw_pictures(card, pictures, columns=1 if many else len(card.shown))
    _draw_patches(card, strip)
    small = [(line, _SMALLEST_PT, "normal") for line in foot]
    _write_lines(below, small, wide_in, heights["foot"], color=QUIET)
    for text in figure.findobj(Text):
        assert isinstance(text, Text)  # what is looked for
        text.set_fontsize(max(_SMALLEST_PT, float(text.get_fontsize())))
    _settle(figure)
    return figure


def _settle(figure: Figure) -> None:
    """Lay the figure out once, rounded, because the last bits of a layout vary."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for part in figure.findobj(SubFigure):
        assert isinstance(part, SubFigure)  # what is looked for
        part.bbox_relative.set_points(np.round(part.bbox_relative.get_points(), _PLACES))
        for text in part.texts:
            text.set_position(np.round(text.get_position(), _PLACES).tolist())
    for ax in figure.axes:
        ax.set_position(Bbox(np.round(ax.get_position(original=True).get_points(), _PLACES)))
    _part_from_gains([ax for ax in figure.axes if ax.get_label() == _BUDGET])


def _parts(of: Figure | SubFigure, rows: int, columns: int, **ratios: Any) -> list[SubFigure]:
    return list(of.subfigures(rows, columns, squeeze=False, **ratios).flat)


_Line = tuple[str, float, str]  # text, size [pt], weight


def _head(card: Card, width_pt: float) -> list[_Line]:
    """Title and sentences, as large as fits the room."""
    first, *others = card.sentences
    most_in = 0.17 * PAPERS_IN[card.paper][1]
    for size in np.arange(14.0, _SMALLEST_PT - 0.5, -0.5).tolist():
        small = max(_SMALLEST_PT, size - 2)
        lines = [(one, small, "normal") for one in _lines(card.title, small, width_pt)]
        lines += [(one, size, "bold") for one in _lines(first, size, width_pt, "bold")]
        for other in others:
            lines += [(one, small, "normal") for one in _lines(other, small, width_pt)]
        if sum(1.25 * one for _, one, _ in lines) / 72 <= most_in:
            break
    return lines


def _lines(text: str, size: float, width_pt: float, weight: str = "normal") -> Iterator[str]:
    """The text in lines that fit a width."""
    line, width = "", 0.0
    for word in re.split(r"(?<!\d)\s", text):  # a number stays with its unit
        more = f" {word}" if line else word
        width += size * _width_em(more, weight)
        if line and width > 0.97 * width_pt:  # fonts of viewers differ a little
            yield line
            line, more, width = "", word, size * _width_em(word, weight)
        line += more
    yield line


@cache
def _width_em(text: str, weight: str) -> float:
    """Advance of a text in DejaVu Sans, which has no kerning with blanks. [font size]"""
    font = FontProperties(family=["DejaVu Sans"], size=1, weight=weight)
    width, _, _ = TextToPath().get_text_width_height_descent(text, font, ismath=False)
    return float(width)


def _write_lines(
    part: SubFigure, lines: Sequence[_Line], wide_in: float, high_in: float, **look: Any
) -> None:
    at = high_in - _EDGE_IN / 2
    for text, size, weight in lines:
        at -= 1.25 * size / 72
        place = (_EDGE_IN / wide_in, (at + 0.3 * size / 72) / high_in)
        part.text(*place, text, fontsize=size, fontweight=weight, va="baseline", **look)


def _heading(part: SubFigure, text: str) -> None:
    left = _EDGE_IN * part.dpi / part.bbox.width
    part.suptitle(text, x=left, ha="left", fontsize=10, fontweight="bold")


def _draw_sensitivities(card: Card, part: SubFigure) -> None:
    points = card.of.operating_points
    chart = sensitivities_chart([one.sensor for one in points])
    axes = part.subplots(1, len(points), sharey=True, squeeze=False)[0]
    for i, ax in enumerate(axes):
        draw_panel(chart, i, ax)
        _entitle(ax, i, card)
        for text in ax.texts:
            text.set_visible(text.get_text() != "near infrared")  # the heading says so
            text.set_fontsize(_SMALLEST_PT if len(points) > 1 else text.get_fontsize())
        ax.set(ylabel="" if i else "QE [e⁻/photon]", xticks=(500, 1000), xlabel="wavelength [nm]")
        ax.yaxis.set_major_locator(MaxNLocator(3))
    _heading(part, "Quantum efficiency (gray: near infrared)")


def _entitle(ax: Axes, i: int, card: Card, more: str = "") -> None:
    """The name of a sensor after its mark, in lines that fit the axes."""
    names = [_cut(one) + more for one in _names(card.of)]
    spec, part = ax.get_subplotspec(), ax.get_figure(root=False)
    assert spec is not None  # axes of a grid
    assert part is not None
    width_in = part.bbox.width / part.dpi / spec.get_gridspec().ncols - _AXIS_IN
    letters = int(width_in / (_LETTER_IN * (_SMALLEST_PT if are_many(names) else 10.5)))
    write_sensor(ax, "", i, names, letters=max(_FEWEST_LETTERS, letters))


def _cut(name: str) -> str:
    return name if len(name) <= _NAME_LETTERS else f"{name[: _NAME_LETTERS - 1]}…"


def _draw_levels(card: Card, part: SubFigure) -> None:
    """SNR of the raw signal and of Y, with a cap where a sensor saturates."""
    of, names = card.of, _names(card.of)
    full = [fullest_level_lux(one) for one in of.operating_points]
    ends = [(1 - 1e-9) * one for one in full if one is not None]
    lux = drawn_lux(of)
    lux = np.unique([*lux, *(one for one in ends if lux[0] < one < lux[-1])])
    first = dict([next(iter(of.makers.items()))])
    last = min(lux[-1], _BEYOND * max(of.study.light.level_lux, *(one or lux[-1] for one in full)))
    ticks = 10.0 ** np.arange(math.ceil(math.log10(lux[0]) - 0.01), math.log10(last) + 0.01)
    axes = part.subplots(1, 2, sharey=True)
    dashes = sensor_dashes(names)  # beside the colors of many sensors, for a gray print
    lines = {name: one | {"linestyle": dashes[name]} for name, one in sensor_lines(names).items()}
    lowest, highest = [-3.0], [24.0]
    titles = ("Raw (best linear readout)", "Y")
    for ax, quantity, title in zip(axes, ("bound", "snr-y"), titles, strict=True):
        curves = compared(of.operating_points, first, lux, quantity=QUANTITIES[quantity])
        values = [one.value for one in curves]
        draw_panel(curves_chart(curves, values, "SNR [dB]", names=[""] * len(curves)), 0, ax)
        for i, (one, end) in enumerate(zip(curves, full, strict=True)):
            ax.lines[i].set_linestyle(dashes[names[i]])
            known = one.value[np.isfinite(one.value)]
            lowest += [max(-20.0, float(known.min()))] if known.size else []
            highest += [float(known.max())] if known.size else []
            if known.size and end is not None and end < lux[-1]:
                look = {"color": lines[names[i]]["color"], "markersize": 18, "markeredgewidth": 2.0}
                ax.plot(end, known[-1], "_", **look)
        for snr_db, text in ((0, "SNR 1"), (20, "SNR 10")):
            ax.axhline(snr_db, color=QUIET, linewidth=1.0, linestyle=(0, (1, 1)), zorder=1)
            ax.text(1.01, snr_db, text, transform=ax.get_yaxis_transform(), va="center")
        ax.axvline(of.study.light.level_lux, color=QUIET, linewidth=1.0, zorder=1)
        ax.set_title(title, fontsize=_SMALLEST_PT, fontweight="normal")
        ax.set(xlim=(lux[0], last), xticks=ticks[:: 1 + len(ticks) // 6])
        ax.xaxis.set_major_formatter("{x:,g}")
        ax.set_xlabel(f"illuminance [lx]; line: {level_in_words(of.study.light.level_lux, 3)}")
    axes[0].set_ylim(min(lowest) - 2, max(highest) + 4)
    axes[1].set_ylabel("")
    _heading(part, "SNR over the light level")
    handles = [Line2D([], [], label=_cut(name), markersize=5, **lines[name]) for name in names]
    for i, handle in enumerate(handles if len(names) > 1 else ()):
        handle.set(**sensor_mark(i, handle.get_color()))
    cap: dict[str, Any] = {"color": QUIET, "markersize": 18, "linestyle": "none"}
    handles.append(Line2D([], [], marker="_", label="saturation", markeredgewidth=2.0, **cap))
    columns = 2 if are_many(names) else min(len(handles), 4)
    place: dict[str, Any] = {"loc": "outside lower left", "borderaxespad": 1.1, "borderpad": 0.0}
    plain: dict[str, Any] = {"frameon": False, "handlelength": 3.0, "labelspacing": 0.2}
    part.legend(handles=handles, ncols=columns, **place, **plain)


def _draw_budgets(card: Card, part: SubFigure) -> None:
    of = card.of
    every = len(of.analyses) <= _MOST_BUDGETS
    chosen = range(len(of.analyses)) if every else card.shown
    has_room = len(of.analyses) <= _MOST_WITH_GAINS
    chart = budget_of(of.analyses, "Y")
    drawn = [i for i in chosen if chart.panels[i].marks]
    rows = rows_of_waterfalls(chart, drawn)
    axes = part.subplots(1, len(chosen), squeeze=False)[0]
    labeled = next(iter(drawn), None)
    for i, ax in zip(chosen, axes, strict=True):
        _entitle(ax, i, card)
        if i in drawn:
            draw_waterfalls(chart, [i], ax, rows=rows)
            ax.tick_params(axis="y", labelleft=i == labeled)
            low, high = ax.get_xlim()
            ax.set_xlim(low, low + (1.05 + 0.06 * len(chosen)) * (high - low))
            ax.set_xlabel("")
            if has_room:
                ax.set_label(_BUDGET)
                _write_gains(chart, i, ax, rows)
        else:
            draw_panel(chart, i, ax).set_axis_off()
    who = "" if every else _some(card)
    gains = "; right: gain from removing that cause alone" if has_room and drawn else ""
    _heading(part, f"SNR budget of Y [dB]{gains}{who}")


def _write_gains(chart: Chart, i: int, ax: Axes, rows: Sequence[str]) -> None:
    """The gain from removing each cause, at the right edge, unless it rounds to 0."""
    place: dict[str, Any] = {"transform": ax.get_yaxis_transform(), "va": "center_baseline"}
    for sensor, step, gain in zip(*(chart.columns[k].values for k in (0, 1, 3)), strict=True):
        text = "" if gain is None else signed(float(gain))
        if sensor == chart.sensors[i] and text.strip("0."):
            ax.text(1.0, rows.index(str(step)), text, ha="right", label=_GAIN, **place)


def _part_from_gains(axes: Sequence[Axes]) -> None:
    """Shorten the bars of budgets that are laid out until no number reaches the gain beside it."""
    spans = [0.0]
    for ax in axes:
        (low, high), box = ax.get_xlim(), ax.bbox
        spans.append(high - low)
        for gain in (one for one in ax.texts if one.get_label() == _GAIN):
            gap = _GAP_EM * float(gain.get_fontsize()) * ax.figure.dpi / 72
            room = gain.get_window_extent().x0 - gap - box.x0
            for one in ax.texts:
                if isinstance(one, Annotation) and one.xy[1] == gain.get_position()[1]:
                    end = (one.xy[0] - low) / (high - low) * box.width
                    beside = one.get_window_extent().x1 - box.x0 - end
                    spans.append((one.xy[0] - low) * box.width / max(room - beside, 1.0))
    for ax in axes:
        ax.set_xlim(ax.get_xlim()[0], ax.get_xlim()[0] + math.ceil(max(spans)))


def _some(card: Card) -> str:
    count = len(card.of.analyses)
    return f": {len(card.shown)} of {count} sensors" if count > len(card.shown) else ""


def _draw_pictures(card: Card, part: SubFigure, *, columns: int) -> None:
    axes = part.subplots(len(card.shown) // columns, columns, squeeze=False).flat
    for i, picture, ax in zip(card.shown, card.pictures, axes, strict=True):
        if picture is not None:
            draw_picture(picture, ax)
            ax.set_anchor("NW")
        else:
            ax.set_axis_off()
            ax.text(0, 1, "no picture: saturated", transform=ax.transAxes, va="top")
        _entitle(ax, i, card)
    level = level_in_words(card.of.study.light.level_lux, 3)
    who = _some(card) if columns > 1 else ""  # else the budgets say so
    _heading(part, f"Picture at {level}{who}")


def _draw_patches(card: Card, part: SubFigure) -> None:
    """True color and that of each sensor, with the color error of each patch."""
    chart = drawn_chart(card.of, Look())
    ax = part.subplots()
    if not chart.panels:
        ax.set_axis_off()
        notes = [one.partition(";")[0] for one in chart.notes]
        ax.text(0, 1, "\n".join(notes), transform=ax.transAxes, va="top")
    else:
        draw_panel(chart, 0, ax)
        labels = [f"{_cut(one.sensor.label)}: {_color(one)}" for one in card.of.analyses]
        ax.set_yticks(range(1 + len(labels)), ["true color", *labels])
        for i, analysis in enumerate(card.of.analyses):
            reason = (saturation_sentence(analysis) or "").partition(": ")[2].partition(";")[0]
            ax.text(0, 1 + i, reason, va="center")
    what = "with the matrix named at the bottom, as budgets and pictures"
    _heading(part, f"Color error of each patch [ΔE*ab, without noise], {what}")


def _color(analysis: Analysis) -> str:
    if analysis.saturated.any():
        return "saturated"
    noise = visual_noise_of(analysis)
    error = mean_color_error(analysis)
    seen = NONE if noise is None else brief(noise, 3)
    return f"mean {decimal(error)}, visual noise {seen}"
