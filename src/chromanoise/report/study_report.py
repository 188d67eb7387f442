"""A study as one self-contained HTML file: verdict, pictures, charts, tables, sliders."""

from collections.abc import Sequence
from itertools import chain
from typing import Any

from chromanoise import __version__
from chromanoise.analysis.machine_reading import machine_reading
from chromanoise.charts import PARTS, Shown, chart_csv, drawing, machine_tables
from chromanoise.charts.explanations import explanation_as_json
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
from chromanoise.report.study_results import (
    map_records,
    matrix_records,
    output_records,
    results_of,
    setting_rows,
    sweep_records,
)
from chromanoise.report.templates import environment
from chromanoise.study import provenance, study_as_toml

_CHARTS = tuple(part for part in PARTS if part != "head")
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
    results = results_of(of)
    sweeps, maps, machine = sweep_records(results), map_records(results), _machine(of)
    sections = [_section(one, full) for one in SECTIONS if _has_content(one.part, sights, maps)]
    return (
        environment()
        .get_template("study.html.j2")
        .render(
            title=of.study.title or _names(of),
            names=_names(of),
            head=full["head"],
            light=of.study.light,
            sections=sections,
            contents=_contents(sections, sweeps, machine),
            sensors=full["head"]["table"],
            slides=data["slides"],
            sights=[_sight(one) for one in sights],
            sweeps=sweeps,
            maps=maps,
            machine=machine,
            machine_explanation=explanation_as_json("machine"),
            matrices=matrix_records(results),
            outputs=output_records(results),
            settings={"head": ["setting", "value", "meaning"], "rows": setting_rows(of.study)},
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


def _has_content(part: str, sights: Sequence[Sight], maps: Sequence[Any]) -> bool:
    return {"picture": bool(sights), "map": bool(maps)}.get(part, True)


def _contents(
    sections: Sequence[dict[str, Any]], sweeps: Sequence[Any], machine: Sequence[Any]
) -> list[tuple[str, str]]:
    """The anchor and the heading of each section, in their order."""
    found = []
    for section in sections:
        if section["part"] == "head":
            continue
        found.append((section["part"], section["heading"]))
        if section["part"] == "levels" and sweeps:
            found.append(("sweeps", "Sweeps"))
    found += [("matrices", "Every sensor and matrix"), ("outputs", "Further results")]
    found += [("machine", "For a machine")] if machine else []
    return [*found, ("sensors", "Sensors in use"), ("made", "How this was made")]


def _section(one: Section, full: dict[str, Any]) -> dict[str, Any]:
    data = full.get(one.part, {})
    return {
        "part": one.part,
        "heading": one.heading,
        "shows": one.shows,
        "fault": data.get("fault"),
        "table": data.get("table", {"head": [], "rows": []}),
        "equations": [(name, explanation_as_json(name)) for name in one.explanations],
    }


def _sight(sight: Sight) -> dict[str, Any]:
    sources = [data_address(png_bytes(picture), "image/png") for picture in sight.pictures]
    sizes = [picture.shape[:2] for picture in sight.pictures]
    shown = zip(sight.sensors, sources, sizes, strict=False)
    return {
        "cube": sight.cube,
        "matrix": sight.matrix,
        "denoised": sight.denoised,
        "pictures": list(shown),
    }


def _machine(of: Shown) -> list[dict[str, Any]]:
    """The tables for a machine, if it is the reader of the study."""
    if of.study.outputs.reader != "machine":
        return []
    return machine_tables([machine_reading(analysis) for analysis in of.analyses])


def _notes(head: dict[str, Any]) -> list[str]:
    return [f"{one['name']}: {note}" for one in head["sensors"] for note in one["notes"]]


def _names(of: Shown) -> str:
    return ", ".join(one.sensor.label for one in of.operating_points)
