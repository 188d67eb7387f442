"""A study as a short script on the public library; its numbers are those of the run."""

import re
from pathlib import Path
from typing import Any

from chromanoise.study.document import PicturePart, SensorPart, Study, SweepPart

_WIDEST = 100
_IMPORTS = {
    "chromanoise.analysis": (
        "QUANTITIES",
        "SWEEPS",
        "analyses_as_json",
        "analyzed",
        "bands_as_json",
        "budgets_as_json",
        "chart_as_json",
        "chart_noise",
        "compared",
        "comparison_as_json",
        "crossover_bands",
        "crossovers",
        "gray_noise",
        "gray_noise_as_json",
        "matrix_as_json",
        "matrix_makers",
        "merits_as_json",
        "merits_of",
        "noise_weights",
        "pareto_of",
        "swept_values",
    ),
    "chromanoise.catalog": ("sensor_with_pixel",),
    "chromanoise.color": ("SPACES", "UNBOUNDED"),
    "chromanoise.exposure": ("EQUAL_TERMS", "Exposure", "Situation"),
    "chromanoise.imaging": ("Work",),
    "chromanoise.imaging.shots": ("Asked", "prepared", "shot", "shot_summary", "write_shot"),
    "chromanoise.io.cubes": ("read_cube",),
    "chromanoise.io.spectra": ("Answers",),
    "chromanoise.metrics": ("matrix_report",),
    "chromanoise.noise": ("Readout",),
    "chromanoise.scene": ("builtin_cube", "flat_field"),
    "chromanoise.sensor": (
        "PixelOverrides",
        "behind_ir_cut",
        "mosaic_named",
        "with_shifted_curves",
    ),
    "chromanoise.study": ("file_word",),
    "chromanoise.study.assembly": ("told_apart",),
    "chromanoise.catalog.resolve": ("behind_filter_of_word", "illuminant_of_word"),
}


def study_as_python(study: Study) -> str:
    """A script that prints what a run of the study computes: a JSON list, one entry per step.

    Pictures are written into the folder in which it is run.
    """
    lines = [
        *_start(study),
        *(_analysis(study) if study.outputs.analyses else []),
        *(_matrix(study) if study.outputs.matrix else []),
        *(line for part in study.sweeps for line in _sweep(study, part)),
        *(line for i in range(len(study.pictures)) for line in _pictures(study, i)),
        "print(json.dumps(results, indent=1))",
    ]
    body = "\n".join(lines)
    imports = ["import json", *(["from pathlib import Path"] if "Path(" in body else []), ""]
    for module, names in _IMPORTS.items():
        used = [name for name in names if re.search(rf"\b{name}\b", body)]
        imports += _import(module, used) if used else []
    title = "".join(c if c.isprintable() else " " for c in study.title).strip()
    return "\n".join([f"# {title or 'A study of chromanoise'}", *imports, "", body]) + "\n"


def _import(module: str, names: list[str]) -> list[str]:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= _WIDEST:
        return [line]
    return [f"from {module} import (", *(f"    {name}," for name in names), ")"]


def _start(study: Study) -> list[str]:
    light, rule = study.light, study.exposure
    columns = (light.column,) if light.column is not None else None
    answers = _call(
        "Answers",
        quantity="power",
        per=light.per,
        beyond=light.beyond,
        columns=columns,
        wavelength_unit=light.wavelength_unit,
        **_unless_refused(negatives=light.negatives),
    )
    lens = {"f_number": rule.f_number, "magnification": rule.magnification}
    exposures = f"EQUAL_TERMS[{rule.equal!r}](white, sensors, "
    exposures += _arguments(share=rule.saturate, **lens) + ")"
    if rule.time_ms is not None:
        time = f"time_s=1e-3 * {rule.time_ms!r}, {_arguments(**lens)}"
        exposures = f"[Exposure({time})] * len(sensors)"
    matrices = f"{list(study.matrices)!r}, {study.metric!r}, prior={study.prior!r}"
    return [
        f"illuminant = illuminant_of_word({light.illuminant!r}, answers={answers})",
        f"white = flat_field(illuminant, level_lux={light.level_lux!r})",
        "sensors = [",
        *(f"    {_sensor(part)}," for part in study.sensors),
        "]",
        f"exposures = {exposures}",
        "situations = [",
        "    Situation(",
        "        sensor=sensor,",
        "        exposure=exposure,",
        "        illuminant=illuminant,",
        "        level_lux=white.level_lux,",
        "    )",
        "    for sensor, exposure in zip(sensors, exposures, strict=True)",
        "]",
        *(["situations = told_apart(situations)"] if _may_share_a_name(study) else []),
        f"makers = matrix_makers({matrices})",
        "results = []",
        "",
    ]


def _may_share_a_name(study: Study) -> bool:
    """A sensor of a file is called as the file, or as its own JSON says."""
    stems = [Path(part.name).stem for part in study.sensors]
    own = any(part.name.lower().endswith(".json") for part in study.sensors)
    return len(set(stems)) < len(stems) or (own and len(stems) > 1)


def _sensor(part: SensorPart) -> str:
    told = {key: value for key, value in part.answers.model_dump().items() if value is not None}
    shared = _unless_refused(beyond=part.beyond, negatives=part.negatives)
    told |= shared
    answers = {"answers": _Code(_call("Answers", **told))} if told else {}
    pixel = part.pixel.model_dump()
    made = _call("sensor_with_pixel", _Code(repr(part.name)), **answers, **pixel)
    if part.shift_nm:
        made = f"with_shifted_curves({made}, {part.shift_nm!r})"
    if part.filter is not None:
        unit = part.filter_wavelength_unit
        told = shared | ({} if unit is None else {"wavelength_unit": unit})
        own = {"answers": _Code(_call("Answers", **told))} if told else {}
        made = _call("behind_filter_of_word", _Code(made), _Code(repr(part.filter)), **own)
    return made if part.ircut_nm is None else f"behind_ir_cut({made}, {part.ircut_nm!r})"


def _unless_refused(**given: str) -> dict[str, str]:
    """The values that are not the default."""
    return {name: value for name, value in given.items() if value != "refuse"}


def _analysis(study: Study) -> list[str]:
    outputs = study.outputs
    readout = (
        "Readout(black_e=0.0, full_well_e=s.sensor.pixel.full_well_e)" if outputs.clip else "None"
    )
    lines = [
        "for name, maker in makers.items():",
        f"    readouts = [{readout} for s in situations]",
        "    analyses = [",
        "        analyzed(white, s.sensor, s.exposure, readout=readout, matrix=maker(s))",
        "        for s, readout in zip(situations, readouts, strict=True)",
        "    ]",
        "    told = analyses_as_json(analyses)",
        '    for own, analysis, readout in zip(told["sensors"], analyses, readouts, strict=True):',
    ]
    inside = []
    if outputs.budget:
        inside.append("own |= budgets_as_json(analysis)")
    if outputs.space is not None:
        inside.append(f"noise = gray_noise(analysis, SPACES[{outputs.space!r}], readout=readout)")
        inside.append('own["grey_noise"] = gray_noise_as_json(noise)')
    if outputs.chart:
        inside.append("noise = chart_noise(analysis, readout=readout or UNBOUNDED)")
        inside.append('own["chart"] = chart_as_json(noise)')
    if outputs.merit:
        inside.append('own["merits"] = merits_as_json(merits_of(analysis, maker=maker))')
    if not inside:
        lines.pop()
    return [*lines, *(f"        {line}" for line in inside), "    results.append(told)", ""]


def _matrix(study: Study) -> list[str]:
    asked, curve = study.outputs.pareto, "None"
    lines = []
    if asked:
        span = f"{asked.first!r}, {asked.last!r}, points={asked.points}"
        lines.append(f"weights = noise_weights({span})")
        curve = f"pareto_of(s, weights, prior={study.prior!r})"
    return [
        *lines,
        "for name, maker in makers.items():",
        "    told = []",
        "    for s in situations:",
        "        made = maker(s)",
        "        report = matrix_report(",
        "            made, s.sensor, s.exposure, illuminant, level_lux=white.level_lux",
        "        )",
        f"        told.append(matrix_as_json(s, made, report, {curve}))",
        '    results.append({"sensors": told})',
        "",
    ]


def _sweep(study: Study, part: SweepPart) -> list[str]:
    lines = [
        f"sweep, quantity = SWEEPS[{part.vary!r}], QUANTITIES[{part.quantity!r}]",
        f"values = swept_values(sweep, {part.first!r}, {part.last!r}, {part.points})",
        "curves = compared(situations, makers, values, sweep=sweep, quantity=quantity)",
        "told = comparison_as_json(curves, crossovers(situations, makers, curves))",
    ]
    bands = '"bands": []'
    if part.all_priors:
        bands = '"bands": bands_as_json(bands)'
        lines += [
            "bands = crossover_bands(",
            f"    situations, {list(study.matrices)!r}, values,",
            f"    metric={study.metric!r}, sweep=sweep, quantity=quantity,",
            ")",
        ]
    return [*lines, f"results.append(told | {{{bands}}})", ""]


def _pictures(study: Study, i: int) -> list[str]:
    part = study.pictures[i]
    first = sum(before.frames for before in study.pictures[:i])
    frames = "0" if first + part.frames == 1 else f"range({first}, {first + part.frames})"
    stem = f'f"picture-{i + 1}-{{word}}-{{file_word(name)}}-{{frame:04d}}"'
    cure = {name: getattr(part, name) for name in ("key", "shape", "wavelengths", "scale")}
    builtin = part.cube.startswith("builtin:")
    cube = _call("builtin_cube" if builtin else "read_cube", _Code(repr(part.cube)), **cure)
    return [
        f"cube = {cube}",
        f"asked = {_asked(part, study.seed)}",
        "pictures = []",
        "for situation in situations:",
        "    word = file_word(situation.sensor.name)",
        "    for name, maker in makers.items():",
        "        camera = prepared(cube, situation, maker(situation), asked)",
        f"        for frame in {frames if frames != '0' else '[0]'}:",
        "            taken = shot(cube, camera, frame=frame, work=Work())",
        f"            stem = {stem}",
        '            files, missing = write_shot(Path("."), stem, taken)',
        '            pictures.append({"matrix": name} | shot_summary(taken, files))',
        f'results.append({{"cube": {part.cube!r}, "pictures": pictures}})',
        "",
    ]


def _asked(part: PicturePart, seed: int) -> str:
    told: dict[str, Any] = {
        "mosaic": "None",
        "raw": repr(part.mosaic is not None),
        "demosaic": repr(None if part.raw_only else part.demosaic or "bilinear"),
        "pixel": _call(
            "PixelOverrides",
            bits=part.bits,
            black_level_dn=part.black_level,
            dark_current_e_per_s=part.dark_current_e_per_s,
            dsnu_e=part.dsnu_e,
            prnu=part.prnu,
            row_noise_e=part.row_noise_e,
        ),
        "seed": repr(seed),
        "clip": repr(part.clip),
        "beyond": repr(part.beyond),
        "bad_pixels": repr(part.bad_pixels),
        "formats": repr(part.formats),
    }
    if part.mosaic not in (None, "sensor"):
        told["mosaic"] = f"mosaic_named({part.mosaic!r})"
    lines = "".join(f"    {name}={value},\n" for name, value in told.items())
    return f"Asked(\n{lines})"


class _Code(str):
    """Words of the script itself, not a value in it."""

    __slots__ = ()


def _call(name: str, *positional: _Code, **given: Any) -> str:
    """A call with the arguments that are given."""
    told = [*positional, _arguments(**{k: v for k, v in given.items() if v is not None})]
    return f"{name}({', '.join(word for word in told if word)})"


def _arguments(**given: Any) -> str:
    return ", ".join(
        f"{name}={value if isinstance(value, _Code) else repr(value)}"
        for name, value in given.items()
    )
