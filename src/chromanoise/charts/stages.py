"""SNR of raw, contravariant and color coordinates, and noise in CIELAB."""

from collections.abc import Sequence

from chromanoise.charts.charted_study import Look, Shown, saturation_sentence
from chromanoise.charts.description import Axis, Chart, Dots, Panel, column
from chromanoise.charts.ellipses import quick_cubature
from chromanoise.charts.numbers import NONE, UNDEFINED, brief, decimal
from chromanoise.color import LAB, propagate
from chromanoise.noise import conditions
from chromanoise.study import (
    GRAY,
    Analysis,
    color_snr_db,
    contravariant_snr_db,
    metric_of,
    noisy_color_at,
    of_white,
    raw_snr_db,
    stages_at,
)

_KINDS = (  # key, title, unit, what it is of
    ("raw", "raw SNR", "dB", "per channel, as read"),
    ("contravariant", "contravariant SNR", "dB", "per channel, unmixed, {metric}"),
    ("spectral", "spectral SNR", "dB", "of the whole reconstructed spectrum, {metric}"),
    ("color", "color SNR", "dB", "per coordinate"),
    ("bound", "bound", "dB", "SNR of the best linear readout"),
    ("price", "color SNR loss", "dB", "best linear SNR minus SNR of Y"),
    ("lab", "noise in CIELAB", "", f"standard deviation of an {brief(100 * GRAY)} % gray"),
)
_ON_ONE_SCALE = ("raw", "contravariant", "spectral", "color", "bound")


Values = dict[str, float | None]


def drawn_stages(shown: Shown, look: Look) -> Chart:
    """Each kind of SNR of a perfect white, and standard deviations of an 18 % gray's L*, a*, b*."""
    analyses = shown.analyses
    names = tuple(analysis.sensor.label for analysis in analyses)
    full = [saturation_sentence(analysis) is not None for analysis in analyses]
    values = [_values(analysis) for analysis in analyses]
    metric = metric_of(analyses)
    shared = [v for one in values for key in _ON_ONE_SCALE for v in one[key].values()]
    rows: list[tuple[str, str, str, str]] = []
    numbers: list[list[float | None]] = []
    texts: list[list[str]] = []
    panels = []
    for key, title, unit, what in _KINDS:
        each, first = [one[key] for one in values], len(rows)
        heading = f"{title} [{unit}]" if unit else title
        for line in dict.fromkeys(name for one in each for name in one):
            rows.append((title, unit, heading, line))
            numbers.append([one.get(line) for one in each])
            shows = zip(each, full, strict=True)
            texts.append([_text(one[line], hit) if line in one else NONE for one, hit in shows])
        scaled = shared if key in _ON_ONE_SCALE else [v for one in numbers[first:] for v in one]
        ends = [0.0, *(value for value in scaled if value is not None)]
        columns = tuple(range(4, 4 + len(names)))
        panel = Panel(
            title=heading,
            remark=what.format(metric=metric),
            explanation=key,
            description=_description(names, rows[first:], numbers[first:], texts[first:]),
            x=Axis(label=unit, low=min(ends), high=max(ends)),
            marks=(Dots(label=3, values=columns, first=first, last=len(rows)),),
        )
        panels += [panel] if len(rows) > first else []
    titles, units, headings, lines = zip(*rows, strict=True)
    return Chart(
        title=f"SNR from raw to color at {conditions(shown.operating_points)}",
        description=" ".join(f"{one.title}: {one.description}" for one in panels),
        sensors=names,
        columns=(
            column("kind", titles, None),
            column("unit", units, None),
            column(None, headings, shown="kind"),
            column("channel or coordinate", lines),
            *(
                column(name, [row[i] for row in numbers], [row[i] for row in texts], shown=name)
                for i, name in enumerate(names)
            ),
        ),
        panels=tuple(panels),
    )


def _values(analysis: Analysis) -> dict[str, Values]:
    """The values of each kind, by channel or coordinate."""
    return {
        "raw": raw_snr_db(analysis),
        "contravariant": contravariant_snr_db(analysis),
        "spectral": {"spectrum": analysis.spectral_snr_db},
        "color": color_snr_db(analysis),
        "bound": {"Y": analysis.optimal_linear_snr_db},
        "price": {"Y": analysis.color_snr_loss_db},
        "lab": _gray_sd(analysis),
    }


def _text(value: float | None, is_full: bool) -> str:
    digits = 0 if value is not None and value >= 1000 else 1
    return decimal(value, digits, "saturated" if is_full else UNDEFINED)


def _description(
    names: Sequence[str],
    rows: Sequence[tuple[str, str, str, str]],
    numbers: Sequence[Sequence[float | None]],
    texts: Sequence[Sequence[str]],
) -> str:
    parts = []
    for i, name in enumerate(names):
        own = [
            f"{line} {text[i]} {unit if number[i] is not None else ''}".strip()
            for (_, unit, _, line), number, text in zip(rows, numbers, texts, strict=True)
            if text[i] != NONE
        ]
        parts.append(f"{name}: {', '.join(own)}.")
    return " ".join(parts)


def _gray_sd(analysis: Analysis) -> dict[str, float | None]:
    white_analysis = of_white(analysis)
    if None in color_snr_db(white_analysis).values():
        return dict.fromkeys(LAB.coordinates)
    point, matrix = analysis.point, analysis.matrix
    gray = stages_at(point, matrix, reflectance=GRAY, readout=analysis.readout)
    white = matrix.matrix @ white_analysis.expected_e
    lab = propagate(noisy_color_at(gray, white), LAB, quick_cubature)
    return dict(zip(lab.measurement.names, lab.sd.tolist(), strict=True))
