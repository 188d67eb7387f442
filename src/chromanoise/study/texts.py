"""A study as TOML, and as the one command that computes it."""

import json
import shlex
from typing import Any

from chromanoise.analysis.color_matrices import trained_names
from chromanoise.analysis.priors import DEFAULT_PRIOR
from chromanoise.study.document import ExposurePart, PicturePart, SensorPart, Study


def study_as_toml(study: Study) -> str:
    """What differs from the defaults, and the sensors; `study_from_text` gives the study back.

    Examples
    --------
    >>> print(study_as_toml(Study(sensors=(SensorPart(name="onyx-rgbw"),))), end="")
    schema = 1
    <BLANKLINE>
    [[sensors]]
    name = "onyx-rgbw"
    """
    told = study.model_dump(mode="json", by_alias=True, exclude_defaults=True)
    lines = ["schema = 1"]
    tables = []
    for key, value in told.items():
        if isinstance(value, dict):
            tables += ["", f"[{key}]", *_pairs(value)]
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for entry in value:
                tables += ["", f"[[{key}]]", *_pairs(entry)]
        else:
            lines.append(f"{key} = {_value(value)}")
    return "\n".join([*lines, *tables]) + "\n"


def _pairs(told: dict[str, Any], prefix: str = "") -> list[str]:
    """``key = value`` lines; tables inside become dotted keys."""
    lines = []
    for key, value in told.items():
        if isinstance(value, dict):
            lines += _pairs(value, f"{prefix}{key}.")
        else:
            lines.append(f"{prefix}{key} = {_value(value)}")
    return lines


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, str):
        # a JSON string is a basic string of TOML, but for the letter DEL
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return str(value).lower() if isinstance(value, bool) else repr(value)


def study_as_command(study: Study) -> str:
    r"""A shell line that computes the same numbers.

    One of ``analyze``, ``compare``, ``matrix`` and ``simulate`` where one says all of it; else
    ``chromanoise run`` of the study itself, as a here-document.

    Examples
    --------
    >>> from chromanoise.study.reading import study_from_text
    >>> text = '[[sensors]]\nname = "onyx-rgbw"\n[light]\nlevel_lux = 3.0'
    >>> study_as_command(study_from_text(text, source="a text"))
    'chromanoise analyze onyx-rgbw --lux 3.0 --budget'
    """
    words = None
    if len({_but_name(sensor) for sensor in study.sensors}) == 1 and not _changed(study):
        words = _analyze(study) or _compare(study) or _matrix(study) or _simulate(study)
    if words is None:
        # no line of this TOML is the bare word that ends the document
        return f"chromanoise run /dev/stdin --out out/study <<'STUDY'\n{study_as_toml(study)}STUDY"
    return shlex.join(["chromanoise", *words])


def _changed(study: Study) -> bool:
    """Whether curves are changed in a way for which no command has an option."""
    return any(
        sensor.shift_nm
        or sensor.ircut_nm is not None
        or sensor.negatives != study.light.negatives  # one option sets both
        for sensor in study.sensors
    )


def _but_name(sensor: SensorPart) -> str:
    return sensor.model_dump_json(exclude={"name"})


def _analyze(study: Study) -> list[str] | None:
    outputs = study.outputs
    only = outputs.analyses and not (outputs.matrix or study.sweeps or study.pictures)
    if not only or len(study.matrices) > 1 or not _each_its_own_time(study):
        return None
    flags = {name: getattr(outputs, name) for name in ("clip", "chart", "budget", "merit")}
    return [
        *_named("analyze", [sensor.name for sensor in study.sensors]),
        *_shared(study),
        *_options(matrix=_unless("kernel", study.matrices[0]), prior=_prior(study), **flags),
        *_options(space=outputs.space),
    ]


def _compare(study: Study) -> list[str] | None:
    outputs = study.outputs
    if outputs.analyses or outputs.matrix or study.pictures or len(study.sweeps) != 1:
        return None
    sweep, pixel = study.sweeps[0], study.sensors[0].pixel
    given = {"time-ms": study.exposure.time_ms, "read-noise-e": pixel.read_noise_e}
    if given.get(sweep.vary) is not None:
        return None  # the command refuses to vary what is given
    prior = _prior(study)
    if sweep.all_priors:
        if not trained_names(study.matrices) or study.prior != DEFAULT_PRIOR:
            return None
        prior = "all"
    return [
        *_named("compare", [sensor.name for sensor in study.sensors]),
        *_shared(study),
        *_options(
            equal=_unless("exposure", study.exposure.equal),
            sweep=f"{sweep.vary}={sweep.first!r}:{sweep.last!r}",
            points=_unless(61, sweep.points),
            quantity=_unless("snr-y", sweep.quantity),
            matrix=_unless("kernel", ",".join(study.matrices)),
            prior=prior,
        ),
    ]


def _matrix(study: Study) -> list[str] | None:
    outputs = study.outputs
    only = outputs.matrix and not (outputs.analyses or study.sweeps or study.pictures)
    if not only or len(study.matrices) > 1 or len(study.sensors) > 1:
        return None
    if not _each_its_own_time(study):
        return None
    asked = outputs.pareto
    return [
        *_named("matrix", [study.sensors[0].name]),
        *_shared(study),
        *_options(
            method=_unless("kernel", study.matrices[0]),
            prior=_unless(DEFAULT_PRIOR, study.prior) if asked else _prior(study),
            pareto=f"{asked.first!r}:{asked.last!r}:{asked.points}" if asked else None,
        ),
    ]


def _simulate(study: Study) -> list[str] | None:
    outputs = study.outputs
    if outputs.analyses or outputs.matrix or study.sweeps or len(study.pictures) != 1:
        return None
    picture = study.pictures[0]
    same = picture.beyond == study.sensors[0].beyond  # the command has one word for both
    if not same or len(study.matrices) > 1 or not _each_its_own_time(study):
        return None
    return [
        *_named("simulate", [picture.cube]),
        *(word for sensor in study.sensors for word in ("--sensor", sensor.name)),
        *_shared(study),
        *_options(matrix=_unless("kernel", study.matrices[0]), prior=_prior(study)),
        *_options(seed=_unless(0, study.seed)),
        *_picture(picture),
    ]


def _picture(picture: PicturePart) -> list[str]:
    apart = {"cube", "beyond", "formats", "shape", "wavelengths"}
    told = picture.model_dump(exclude=apart, exclude_defaults=True)
    shape, said = picture.shape, picture.wavelengths
    return _options(
        format=",".join(picture.formats) if picture.formats else None,
        shape=f"{shape[0]}x{shape[1]}" if shape else None,
        wavelengths=f"{said[0]!r}:{said[1]!r}" if isinstance(said, tuple) else said,
        **told,
    )


def _each_its_own_time(study: Study) -> bool:
    """As analyze, matrix and simulate have it: they solve a time for each sensor."""
    rule: ExposurePart = study.exposure
    alone = len(study.sensors) == 1 and rule.equal == "exposure"
    return rule.time_ms is not None or rule.equal == "saturation" or alone


def _shared(study: Study) -> list[str]:
    light, exposure, sensor = study.light, study.exposure, study.sensors[0]
    either = {"photon": "illuminant-photons", "energy": "illuminant-energy"}
    answers = [sensor.answers.scale, sensor.answers.level]
    per = {"photon": "photons", "energy": "energy"}.get(sensor.answers.per or "")
    flags = [either.get(light.per or ""), *answers, per]
    return [
        *_options(
            illuminant=_unless("E", light.illuminant),
            lux=_unless(10.0, light.level_lux),
            time_ms=exposure.time_ms,
            saturate=_unless(0.99, exposure.saturate) if exposure.time_ms is None else None,
            f_number=_unless(1.8, exposure.f_number),
            metric=_unless("quanta", study.metric),
            beyond=_unless("refuse", sensor.beyond),
            illuminant_beyond=_unless("refuse", light.beyond),
            illuminant_column=light.column,
            illuminant_wavelength_unit=light.wavelength_unit,
            wavelength_unit=sensor.answers.wavelength_unit,
            negatives=_unless("refuse", sensor.negatives),
            magnification=exposure.magnification,
            pixel=sensor.pixel.file,
            **sensor.pixel.model_dump(exclude={"file"}),
            filter=sensor.filter,
            filter_wavelength_unit=sensor.filter_wavelength_unit,
            peak_qe=sensor.answers.peak_qe,
        ),
        *(f"--{flag}" for flag in flags if flag),
    ]


def _prior(study: Study) -> str | None:
    """A prior is refused where no matrix looks at it."""
    return _unless(DEFAULT_PRIOR, study.prior) if trained_names(study.matrices) else None


def _unless(default: Any, value: Any) -> Any:
    return None if value == default else value


def _named(command: str, names: list[str]) -> list[str]:
    """The names right behind the command; one that looks like an option is told as a path."""
    return [command, *(f"./{name}" if name.startswith("-") else name for name in names)]


def _options(**given: Any) -> list[str]:
    words = []
    for name, value in given.items():
        option = f"--{name.replace('_', '-')}"
        if value is True:
            words.append(option)
        elif value is not None and value is not False:
            words += [option, value if isinstance(value, str) else repr(value)]
    return words
