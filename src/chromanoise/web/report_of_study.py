"""A study as one self-contained HTML file: verdict, pictures, charts, tables, sliders."""

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np

from chromanoise.base import (
    Array,
    InputError,
    Record,
    UInt8,
    __version__,
    check,
    dataclass,
    from_above,
)
from chromanoise.charts import (
    MOST_ON_CARD,
    PARTS,
    SECTIONS,
    Section,
    Shown,
    as_data,
    at_level,
    channels_table,
    chart_csv,
    color_table,
    drawing,
    explanation_as_json,
    machine_tables,
    outcome_tables,
    pareto_table,
    shown_at,
)
from chromanoise.imaging import Work, png_bytes
from chromanoise.io import Table, head, written_rows
from chromanoise.noise import OperatingPoint, level_in_words
from chromanoise.spectra import is_infrared
from chromanoise.study import (
    SWEEPS,
    Comparison,
    ComparisonMap,
    Results,
    Study,
    machine_reading,
    prepared_cameras,
    provenance,
    result_steps,
    study_as_toml,
    taken_pictures,
)
from chromanoise.web.report_bundle import (
    data_address,
    drawing_style,
    environment,
    import_map,
    packed_json,
    report_script,
    script_hash,
    shortened,
)

_CHARTS = tuple(part for part in PARTS if part != "head")


@dataclass(frozen=True, kw_only=True, eq=False)
class Sight:
    """One cube through every sensor.

    Attributes
    ----------
    cube
        As the study names it.
    denoised
        Name of the denoising method; empty for the noisy picture.
    matrix
        With which the colors are made.
    sensors
        Names, one per picture.
    pictures
        8-bit sRGB; none where the study asks for codes without color.
    """

    cube: str
    matrix: str
    sensors: tuple[str, ...]
    pictures: tuple[UInt8[Array, "h w 3"], ...]
    denoised: str = ""

    def __post_init__(self) -> None:
        if self.pictures:
            check.same_length("pictures", sensors=len(self.sensors), pictures=len(self.pictures))


def sights_of(of: Shown, *, work: Work | None = None) -> tuple[Sight, ...]:
    """The first frame of each cube of a study through every sensor, with the first matrix.

    A cube whose pictures are denoised has two sights: before and after.

    Parameters
    ----------
    of
        The study with its results.
    work
        Threads and memory of the computation; ``None`` for the default.

    Raises
    ------
    InputError
        If a cube cannot be read, or holds what is no reflectance.
    """
    names = tuple(one.sensor.label for one in of.operating_points)
    matrix, maker = next(iter(of.makers.items()))
    sights = []
    for number, part in enumerate(of.study.pictures):
        cube, cameras = prepared_cameras(
            of.study, number, list(of.operating_points), {matrix: maker}
        )
        for method in dict.fromkeys((None, part.denoise)):
            study = _denoised_by(of.study, number, method)
            taken = taken_pictures(study, number, cube, cameras, work=work or Work(), frames=1)
            colors = (one.capture.picture for one in taken)
            pictures = tuple(picture.srgb for picture in colors if picture is not None)
            sights.append(
                Sight(
                    cube=part.cube,
                    matrix=matrix,
                    sensors=names,
                    pictures=pictures,
                    denoised=method or "",
                )
            )
    return tuple(sights)


def _denoised_by(study: Study, number: int, method: str | None) -> Study:
    """The study with one denoising method for a part of its pictures (from 0)."""
    parts = list(study.pictures)
    parts[number] = parts[number].model_copy(update={"denoise": method})
    return study.model_copy(update={"pictures": tuple(parts)})


_STEP = 10.0 ** (1 / 8)  # of the light level: eight steps per decade
_MOST_ABOVE = 12
_MOST_ANSWERS = 25
_ROOM = 50  # answers of one sensor: more sensors have fewer each, so that the file stays small
_EDGES_NM = (600.0, 620.0, 640.0, 660.0, 680.0, 700.0, 725.0, 750.0, 800.0, 850.0, 900.0, 950.0)
_RATIOS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)  # of infrared to light. [W/W]
_DIODE_NM = 850.0
_SEES_INFRARED = 0.02  # QE below which a channel is blind to it. [e-/photon]


@dataclass(frozen=True, kw_only=True, eq=False)
class Slide:
    """One slider.

    Attributes
    ----------
    label
        Label of the setting that it changes.
    values
        Values in the unit of the sweep; ``None`` is the unchanged study, where no value gives it.
    texts
        Text of each value.
    own
        Index of the unchanged study.
    """

    key: str
    label: str
    values: tuple[float | None, ...]
    texts: tuple[str, ...]
    own: int

    def __post_init__(self) -> None:
        check.same_length("positions", values=len(self.values), texts=len(self.texts))


def slides_of(of: Shown) -> tuple[Slide, ...]:
    """The sliders that make sense for a study: the light level, an IR-cut where one matters, and
    infrared in the light where a sensor sees it.

    The light level goes up to where every sensor is saturated, for the time is the study's own.
    """
    count = max(5, min(_MOST_ANSWERS, _ROOM // len(of.operating_points)))
    step = (len(of.operating_points) + 1) // 2
    infrared = (_ir_cut(_EDGES_NM[::step]),) if _sees_infrared(of.operating_points) else ()
    more = (_infrared(_RATIOS[:: (step + 1) // 2]),) if _sees_diode(of.operating_points) else ()
    return (_level(of, count), *infrared, *more)


def at_value(of: Shown, slide: Slide, value: float | None) -> Shown:
    """The study with one setting changed and all others, including the time, kept.

    Parameters
    ----------
    slide
        What is changed; its key is one of `chromanoise.study.SWEEPS`.
    value
        To what; ``None`` changes nothing. [unit of the sweep]

    Raises
    ------
    InputError
        As `chromanoise.charts.shown_at`.
    """
    if value is None:
        return of
    change = SWEEPS[slide.key].at
    return shown_at(of, tuple(change(one, value) for one in of.operating_points))


def _level(of: Shown, count: int) -> Slide:
    own = of.study.light.level_lux
    above = 1
    slide = Slide(key="lux", label="Light level", values=(), texts=(), own=0)
    while above < min(_MOST_ABOVE, count // 2) and not _all_saturated(of, slide, own, above):
        above += 1
    steps = range(above - count + 1, above + 1)
    values = [float(f"{own * _STEP**i:.3g}") if i else own for i in steps]
    texts = [level_in_words(value) for value in values]
    return replace(slide, values=tuple(values), texts=tuple(texts), own=count - 1 - above)


def _all_saturated(of: Shown, slide: Slide, own: float, above: int) -> bool:
    there = at_value(of, slide, own * _STEP**above)
    return all(analysis.saturated.any() for analysis in there.analyses)


def _ir_cut(edges_nm: Sequence[float]) -> Slide:
    texts = [f"at {edge:g} nm" for edge in edges_nm]
    return Slide(
        key="ircut-nm",
        label="IR-cut added before every sensor",
        values=(*edges_nm, None),
        texts=(*texts, "none"),
        own=len(edges_nm),
    )


def _infrared(ratios: Sequence[float]) -> Slide:
    return Slide(
        key="infrared",
        label="Infrared added to the light, 850 nm",
        values=(None, *ratios),
        texts=("none", *(f"{ratio:g} W per W of light" for ratio in ratios)),
        own=0,
    )


def _sees_diode(operating_points: Sequence[OperatingPoint]) -> bool:
    seen = (
        np.interp(_DIODE_NM, one.sensor.grid.wavelength_nm, one.sensor.qe.max(axis=1))
        for one in operating_points
    )
    return bool(max(seen) > _SEES_INFRARED)


def _sees_infrared(operating_points: Sequence[OperatingPoint]) -> bool:
    for one in operating_points:
        beyond = is_infrared(one.sensor.grid)
        lit = one.illuminant.irradiance > 0
        if (beyond & lit).any() and np.max(one.sensor.qe[beyond & lit]) > _SEES_INFRARED:
            return True
    return False


def changed_keys(answer: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    """Of every part only what differs from the study's own answer; a part of other keys whole.

    Examples
    --------
    >>> changed_keys({"a": {"x": 1, "y": 3}, "b": {"z": 1}}, {"a": {"x": 1, "y": 2}, "b": {"z": 1}})
    {'a': {'y': 3}}
    >>> changed_keys({"a": {"fault": "none"}}, {"a": {"x": 1}})
    {'a': {'whole': {'fault': 'none'}}}
    """
    texts: dict[str, Any] = {}
    for part, data in answer.items():
        if data.keys() != own[part].keys():
            texts[part] = {"whole": data}
        elif differing := {key: value for key, value in data.items() if value != own[part][key]}:
            texts[part] = differing
    return texts


def slide_as_json(
    slide: Slide, answers: Sequence[dict[str, Any]], own: dict[str, Any]
) -> dict[str, Any]:
    """A slider with its answers, as `changed_keys` of the study's own, by part.

    What is alike in them then stands together, and compresses well.
    """
    changed = [changed_keys(answer, own) for answer in answers]
    return {
        "key": slide.key,
        "label": slide.label,
        "values": list(slide.values),
        "texts": list(slide.texts),
        "own": slide.own,
        "answers": {part: [one.get(part, {}) for one in changed] for part in own},
    }


def study_report(of: Shown, sights: Sequence[Sight] = (), *, work: Work | None = None) -> str:
    """The report as self-contained HTML, without network access.

    Parameters
    ----------
    sights
        Its pictures, of ``report_of_study``.
    work
        Threads of the pictures of its card.

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
            card=_card(of, work),
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


def _card(of: Shown, work: Work | None) -> str:
    """The card as a data URL, A4 landscape.

    Empty if there are more sensors than it holds, or nothing that draws it.
    """
    if find_spec("matplotlib") is None or len(of.operating_points) > MOST_ON_CARD:
        return ""
    card = from_above("figures").card_of(of, paper="a4", work=work)
    return data_address(card.content("svg"), "image/svg+xml")


def report_data(of: Shown, full: dict[str, Any] | None = None) -> dict[str, Any]:
    """What the drawing modules get: the study's own parts, and what differs at each slider.

    Numbers have as many digits as are shown (``shortened``).

    Parameters
    ----------
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
    return {**parts, "levels": at_level(full["levels"], there.study.light.level_lux)}


def _parts(of: Shown, wanted: Sequence[str] = tuple(PARTS)) -> dict[str, Any]:
    """Every drawing; one that cannot be made says why in its place."""
    drawings: dict[str, Any] = {}
    for part in wanted:
        try:
            drawings[part] = as_data(drawing(part, of))
        except InputError as error:
            drawings[part] = {"fault": str(error)}
    return drawings


def _packed(full: dict[str, Any]) -> dict[str, Any]:
    """The parts as they stand in the file; the head as sentences and rows."""
    drawings = {part: shortened(data) for part, data in full.items()}
    drawings["head"] = {"verdict": full["head"]["verdict"], "table": full["head"]["table"]}
    return drawings


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
    tables = machine_tables([machine_reading(analysis) for analysis in of.analyses])
    return list(map(table_record, tables))


def _notes(head: dict[str, Any]) -> list[str]:
    return [f"{one['name']}: {note}" for one in head["sensors"] for note in one["notes"]]


def _names(of: Shown) -> str:
    return ", ".join(one.sensor.label for one in of.operating_points)


_SIZE_IN = (7.2, 4.2)
_DOTS_PER_IN = 96  # of a screen


def results_of(of: Shown) -> Results:
    """Compute the results of a study that its charts do not have: all but its pictures.

    Analyses and matrices are among them whether the study asks for them or not.

    Raises
    ------
    InputError
        If a result cannot be computed.
    """
    outputs = of.study.outputs.model_copy(update={"analyses": True, "matrix": True})
    study = of.study.model_copy(update={"outputs": outputs})
    steps = result_steps(study, list(of.operating_points), of.makers)
    # by number, as files of matrices in two folders may give steps of one name
    found = {f"{i}": step.run(None, lambda _: None) for i, step in enumerate(steps)}
    return Results(study=study, points=of.operating_points, steps=found)


def table_record(table: Table) -> dict[str, Any]:
    """A table as text: ``title``, ``head``, ``rows``, ``notes``."""
    return {
        "title": table.title,
        "head": [_typeset(head(column)) for column in table.columns],
        "rows": [[_typeset(text) for text in row] for row in written_rows(table)],
        "notes": [_typeset(note) for note in table.notes],
    }


def _typeset(text: str) -> str:
    """A text of a terminal with the signs of print: ΔE, e⁻, a true minus before a number."""
    text = re.sub(r"(^|[ (\[/])e-(?=$|[ )\]/,;:])", r"\1e⁻", text.replace("Delta E", "ΔE"))
    return re.sub(r"(^|[ (\[])-(?=[\d.])", "\\1\N{MINUS SIGN}", text)


def sweep_records(results: Results) -> list[dict[str, Any]]:
    """Each sweep of one parameter: title, picture, sentences, table."""
    return [_pictured(one, one.shown_sentences, "svg", "image/svg+xml") for one in results.sweeps]


def map_records(results: Results) -> list[dict[str, Any]]:
    """Each sweep of two parameters: title, picture, table."""
    return [_pictured(one, [], "png", "image/png") for one in results.maps]


def _pictured(
    one: Comparison | ComparisonMap, sentences: list[str], ending: str, kind: str
) -> dict[str, Any]:
    from matplotlib.figure import Figure  # slow to import, and only a sweep needs it

    from chromanoise.charts import chromanoise_style, figure_bytes

    with chromanoise_style():
        figure = Figure(figsize=_SIZE_IN, layout="constrained")
        ax = one.plot(figure.add_subplot())
        caption = ax.get_title(loc="left")
        ax.set_title("", loc="left")
    table = one.to_table()
    return {
        "title": table.title,
        "caption": caption,
        "source": data_address(figure_bytes(figure, ending), kind),
        "width": round(_DOTS_PER_IN * _SIZE_IN[0]),
        "height": round(_DOTS_PER_IN * _SIZE_IN[1]),
        "sentences": [_typeset(sentence) for sentence in sentences],
        "table": table_record(table),
    }


def matrix_records(results: Results) -> list[dict[str, Any]]:
    """SNR and error of every sensor with every matrix, then the coefficients of each matrix."""
    analyses = list(results.analyses.values())
    tables = [color_table(analyses), channels_table(analyses[0].analyses)]
    tables += [replace(one.to_table(), notes=()) for one in results.matrices.values()]  # see above
    return [table_record(table) for table in tables if table.rows]


def output_records(results: Results) -> list[dict[str, Any]]:
    """The tables of the outputs that the study asks for: ``title`` and ``tables`` per matrix."""
    groups = [
        {"title": f"With the {one.matrix} matrix", "tables": list(map(table_record, tables))}
        for one in results.analyses.values()
        if (tables := list(outcome_tables(one)))
    ]
    curves = [
        table_record(pareto_table(one.pareto, one.report, one.point.sensor.label))
        for one in next(iter(results.matrices.values())).results
        if one.pareto is not None
    ]
    return [
        *groups,
        *([{"title": "With any weight of the noise", "tables": curves}] if curves else []),
    ]


def setting_rows(study: Study) -> list[list[str]]:
    """Key, value and meaning of every setting that is not the default."""
    return list(_settings(study, ""))


def _settings(part: Record, key: str) -> Iterator[list[str]]:
    for name, field in type(part).model_fields.items():
        value = getattr(part, name)
        inner = f"{key}{field.alias or name}"
        if isinstance(value, Record):
            yield from _settings(value, f"{inner}.")
        elif isinstance(value, tuple) and any(isinstance(one, Record) for one in value):
            for i, one in enumerate(value):
                yield from _settings(one, f"{inner}.{i}.")
        elif value != field.default:
            text = value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
            yield [inner, text, field.description or ""]
