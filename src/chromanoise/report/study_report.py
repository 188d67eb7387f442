"""A study as one self-contained HTML file: verdict, charts, tables, equations, sliders."""

from collections.abc import Sequence
from importlib import resources
from io import BytesIO
from itertools import chain
from typing import Any

import jinja2

from chromanoise import __version__
from chromanoise.analysis.machine_reading import machine_reading
from chromanoise.charts import PARTS, Shown, chart_csv, drawing, machine_tables
from chromanoise.charts.explanations import EXPLANATIONS
from chromanoise.charts.sections import SECTIONS, Section
from chromanoise.errors import InputError
from chromanoise.geometry import unit_circle
from chromanoise.imaging import png_bytes
from chromanoise.report.bundle import (
    data_address,
    drawing_style,
    import_map,
    packed_json,
    report_script,
    script_hash,
    shortened,
)
from chromanoise.report.slides import Slide, at_value, slide_as_json, slides_of
from chromanoise.report.study_pictures import Sight
from chromanoise.study import provenance, study_as_toml

_CHARTS = tuple(part for part in PARTS if part != "head")
_DOTS_PER_IN = 220  # of a heat map, shown at half its size
_EXACT = 7  # digits of half axes: an outline is whole to a thousandth of its unit


def study_report(of: Shown, sights: Sequence[Sight] = ()) -> str:
    """The report as self-contained HTML, without network access.

    Parameters
    ----------
    of
        The study.
    sights
        Its pictures, of `chromanoise.report.study_pictures`.

    Raises
    ------
    InputError
        If a file that the study names cannot be read, or a value of a slider cannot be computed.
    """
    full = _parts(of)
    data = report_data(of, full)
    script, modules = report_script(), import_map()
    template = resources.files("chromanoise.report").joinpath("study.html.j2").read_text("utf-8")
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    return environment.from_string(template).render(
        title=of.study.title or _names(of),
        names=_names(of),
        head=full["head"],
        light=of.study.light,
        sections=[
            _section(one, full) for one in SECTIONS if one.part in full and one.part != "head"
        ],
        sensors=full["head"]["table"],
        slides=data["slides"],
        sights=[_sight(one) for one in sights],
        maps=_maps(of),
        machine=_machine(of),
        notes=_notes(full["head"]),
        faults=[data["fault"] for data in full.values() if "fault" in data],
        provenance=provenance(of.study),
        toml=study_as_toml(of.study),
        version=__version__,
        style=drawing_style(),
        import_map=modules,
        script=script,
        hashes=f"{script_hash(modules)} {script_hash(script)}",
        data=packed_json(data),
    )


def report_data(of: Shown, full: dict[str, Any] | None = None) -> dict[str, Any]:
    """What the drawing modules get: the study's own parts, and what differs at each slider.

    Outlines of ellipses are given by center and half axes on one common ``circle``, numbers by as
    many digits as are shown (`chromanoise.report.bundle.shortened`).

    Parameters
    ----------
    of
        The study.
    full
        Its parts, if they are known.
    """
    full = full or _parts(of)
    own = _packed(full)
    slides = slides_of(of)
    answers = [[_there(of, slide, value, full) for value in slide.values] for slide in slides]
    return {
        "parts": own,
        # of the study itself, to full precision
        "csv": {part: chart_csv(part, one) for part, one in full.items() if "fault" not in one},
        "chart_of": shortened(_chart_of([full, *chain.from_iterable(answers)])),
        "slides": [
            slide_as_json(slide, [_packed(one) for one in drawings], own)
            for slide, drawings in zip(slides, answers, strict=True)
        ],
    }


def _there(of: Shown, slide: Slide, value: float | None, full: dict[str, Any]) -> dict[str, Any]:
    """The parts at a position of a slider; curves over the light know every level already."""
    if value == slide.values[slide.own]:
        return full
    there = at_value(of, slide, value)
    if slide.key != "lux" or "fault" in full["levels"]:
        return _parts(there)
    parts = _parts(there, tuple(part for part in PARTS if part != "levels"))
    moved = {**full["levels"], "now_lux": there.study.light.level_lux}
    return {**parts, "levels": moved}


def _parts(of: Shown, wanted: Sequence[str] = tuple(PARTS)) -> dict[str, Any]:
    """Every drawing; one that cannot be made says why in its place."""
    drawings: dict[str, Any] = {}
    for part in wanted:
        try:
            drawings[part] = drawing(part, of)
        except InputError as error:
            drawings[part] = {"fault": str(error)}
    return drawings


def _packed(full: dict[str, Any]) -> dict[str, Any]:
    """The parts as they stand in the file; the head as sentences and rows."""
    drawings = {part: shortened(data) for part, data in full.items() if part != "ellipses"}
    drawings["head"] = {"verdict": full["head"]["verdict"], "table": full["head"]["table"]}
    drawings["ellipses"] = _packed_ellipses(full["ellipses"])
    return drawings


def _packed_ellipses(data: dict[str, Any]) -> dict[str, Any]:
    if "fault" in data:
        return data
    sensors = [
        {**sensor, "patches": [_packed_ellipse(patch) for patch in sensor["patches"]]}
        for sensor in data["sensors"]
    ]
    return {**data, "sensors": sensors}


def _packed_ellipse(patch: dict[str, Any]) -> list[Any]:
    """Center, two conjugate half axes, and reach."""
    numbers = [patch["center"], *patch["half_axes"], patch["reach"]]
    packed: list[Any] = shortened(numbers, digits=_EXACT)
    return packed


def _chart_of(answers: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """What all ellipses share: name, color and truth of each patch, and the points of a circle."""
    sensors = chain.from_iterable(one["ellipses"].get("sensors", ()) for one in answers)
    found = (sensor["patches"] for sensor in sensors if sensor["patches"])
    seen: list[dict[str, Any]] = next(found, [])
    return {
        "circle": unit_circle(len(seen[0]["outline"])).tolist() if seen else [],
        "patches": [{key: patch[key] for key in ("name", "srgb", "truth")} for patch in seen],
    }


def _section(one: Section, full: dict[str, Any]) -> dict[str, Any]:
    data = full[one.part]
    return {
        "part": one.part,
        "heading": one.heading,
        "shows": one.shows,
        "fault": data.get("fault"),
        "table": data.get("table", {"head": [], "rows": []}),
        "equations": [(name, EXPLANATIONS[name]) for name in one.explanations],
    }


def _sight(sight: Sight) -> dict[str, Any]:
    sources = [data_address(png_bytes(picture), "image/png") for picture in sight.pictures]
    sizes = [picture.shape[:2] for picture in sight.pictures]
    shown = zip(sight.sensors, sources, sizes, strict=False)
    return {"cube": sight.cube, "matrix": sight.matrix, "pictures": list(shown)}


def _machine(of: Shown) -> list[dict[str, Any]]:
    """The tables for a machine, if it is the reader of the study."""
    if of.study.outputs.reader != "machine":
        return []
    return machine_tables([machine_reading(analysis) for analysis in of.analyses])


def _maps(of: Shown) -> list[dict[str, Any]]:
    """The heat map of each sweep of two parameters as a picture."""
    if all(part.second is None for part in of.study.sweeps):
        return []
    from chromanoise.figures import map_figures  # matplotlib is slow to import

    shown = []
    for figure in map_figures(of).values():
        buffer = BytesIO()
        figure.savefig(buffer, format="png", dpi=_DOTS_PER_IN, metadata={"Software": None})
        what = ", ".join(text for ax in figure.axes for text in (ax.get_title(loc="left"),) if text)
        width, height = (round(_DOTS_PER_IN * side / 2) for side in figure.get_size_inches())
        source = data_address(buffer.getvalue(), "image/png")
        shown.append({"what": what, "source": source, "width": width, "height": height})
    return shown


def _notes(head: dict[str, Any]) -> list[str]:
    return [f"{one['name']}: {note}" for one in head["sensors"] for note in one["notes"]]


def _names(of: Shown) -> str:
    return ", ".join(one.sensor.label for one in of.operating_points)
