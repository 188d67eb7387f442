"""Preview of an uploaded file: how it was parsed, and which metadata it lacks."""

from typing import Any

from chromanoise.catalog import own_sensor_of
from chromanoise.errors import InputError, Setting, StudyError, errors_in
from chromanoise.io.spectra import ParsedSpectra, read_curves
from chromanoise.io.spectra.defects import defects_of_a_light
from chromanoise.page.pictures import cube_of_upload
from chromanoise.page.requests import QuestionError, page_sentence
from chromanoise.page.studies import served_data
from chromanoise.page.uploads import Upload, in_words
from chromanoise.scene.rows import row_source
from chromanoise.spectra import DEFAULT_GRID, Spectra
from chromanoise.study import study_from_text

MOST_SPECTRUM_BYTES = 1_000_000  # some 50,000 rows, which are understood in half a second
_MOST_STUDY_BYTES = 100_000  # many keys take quadratic time to parse; the starter study has 2.5 kB
_MOST_NAMES = 12
_ASKS = {
    "scale": ("answers.scale", ["fraction", "percent"]),
    "level": ("answers.level", ["absolute", "relative"]),
    "per": ("answers.per", ["photon", "energy"]),
    "peak_qe": ("answers.peak_qe", []),
    "beyond": ("beyond", ["zero", "hold"]),
}
_OF_LIGHT = {"per": "per", "beyond": "beyond"}

Data = dict[str, Any]


def preview_of(upload: Upload) -> Data:
    """The JSON of ``/api/upload``.

    Raises
    ------
    QuestionError
        If it cannot be read, in one sentence.
    """
    try:
        preview = _preview(upload)
    except InputError as error:
        # of a study all faults are shown, a line each
        if isinstance(error, StudyError) and error.places:
            sentences = error.sentences()
        else:
            sentences = [_without_settings(one) for one in errors_in(error)]
        raise QuestionError(*(("file", in_words(line, upload)) for line in sentences)) from None
    lines = [in_words(line, upload) for line in preview["preview"]]
    return {"asks": [], "study": None} | preview | {"id": upload.id, "preview": lines}


def _without_settings(error: InputError) -> str:
    """The sentence for a file that the page has no controls for: it must declare more itself."""
    settings = [one.name for one in error.remedy if isinstance(one, Setting)]
    names = [name.rpartition(".")[2].replace("_", " ") for name in settings]
    if not names:
        return page_sentence(error)
    rest = [one for one in error.remedy if not isinstance(one, Setting)]
    message = f"the page has no control for {' and '.join(names)}: write it into the file"
    return InputError(
        error.subject,
        error.requirement,
        value=error.value,
        found=error.found,
        where=error.where,
        remedy=(*rest, message),
    ).sentence()


def _preview(upload: Upload) -> Data:
    if upload.kind == "study":
        return _study(upload)
    if upload.kind == "cube":
        return _cube(upload)
    if upload.kind == "either":
        try:
            return _spectra(upload)
        except InputError:
            return _cube(upload)
    return _spectra(upload)


def _study(upload: Upload) -> Data:
    if upload.size_bytes > _MOST_STUDY_BYTES:
        raise InputError(
            upload.label,
            f"must have at most {_MOST_STUDY_BYTES / 1e6:g} MB, as a study",
            value=upload.size_bytes,
            found=f"has {upload.size_bytes / 1e6:.1f} MB",
        )
    try:
        text = upload.path.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(
            upload.label, "is not a UTF-8 text file", remedy="save the study as UTF-8"
        ) from None
    study = study_from_text(text, source=upload.label, keep_idle=True)
    data = served_data(study)
    names = ", ".join(part.name for part in study.sensors)
    lines = [
        f"A study of {names} in {study.light.illuminant} at {study.light.level_lux:g} lx, "
        f"matrix {', '.join(study.matrices)}."
    ]
    if study.title:
        lines.insert(0, study.title if study.title[-1] in ".?!" else f"{study.title}.")
    return {"kind": "study", "preview": lines, "study": data}


def _cube(upload: Upload) -> Data:
    cube = cube_of_upload(upload)
    height, width, _ = row_source(cube.stored).shape
    at = cube.wavelength_nm
    lines = [
        f"A cube of {height} x {width} pixels, {at.size} bands from {at[0]:g} to {at[-1]:g} nm.",
        *cube.notes,
    ]
    first, last = DEFAULT_GRID.wavelength_nm[[0, -1]]
    short = [end for end, is_short in ((at[0], at[0] > first), (at[-1], at[-1] < last)) if is_short]
    return {
        "kind": "cube",
        "preview": lines,
        "asks": [_beyond(short, first, last)] if short else [],
    }


def _beyond(ends_nm: list[float], first_nm: float, last_nm: float) -> Data:
    """What a cube is asked whose bands do not reach over what sensors answer to."""
    ends = " and ".join(f"{end:g}" for end in ends_nm)
    question = (
        f"its bands end at {ends} nm, and sensors respond from {first_nm:g} to {last_nm:g} nm: "
        "hold the last value there (hold), or take it as black (zero)?"
    )
    return {"key": "beyond", "question": question, "choices": ["hold", "zero"]}


def _spectra(upload: Upload) -> Data:
    if upload.size_bytes > MOST_SPECTRUM_BYTES:
        raise InputError(
            upload.label,
            f"must have at most {MOST_SPECTRUM_BYTES / 1e6:g} MB, as spectra on the page",
            value=upload.size_bytes,
            found=f"has {upload.size_bytes / 1e6:.1f} MB",
            remedy="keep one row per nanometer",
        )
    own = own_sensor_of(upload.path)
    if own is not None:
        line = f"A sensor of this library, {own.name}: channels {', '.join(own.names)}."
        return {"kind": "sensor", "preview": [line, *own.notes]}
    parsed = read_curves(upload.path)
    kind = _kind(parsed)
    return {"kind": kind, "preview": _sentences(parsed, kind), "asks": _asks(parsed, kind)}


def _kind(parsed: ParsedSpectra) -> str:
    """A light where it is one or may be: one curve of nobody knows what."""
    if parsed.quantity == "power":
        return "light"
    if parsed.quantity in ("reflectance", "transmittance"):
        raise InputError(
            str(parsed.curves.source),
            "must hold the curves of a sensor or a light",
            value=parsed.quantity,
            found=f"holds {parsed.quantity}s",
        )
    return "light" if parsed.quantity is None and len(parsed.curves.names) == 1 else "sensor"


def _sentences(parsed: ParsedSpectra, kind: str) -> list[str]:
    curves: Spectra = parsed.curves
    names = ", ".join(curves.names[:_MOST_NAMES])
    more = ", ..." if len(curves.names) > _MOST_NAMES else ""
    what = "A light" if kind == "light" else "A sensor"
    count = f"{len(curves.names)} curve{'s' if len(curves.names) > 1 else ''}"
    own = kind == "sensor" and parsed.own_form and parsed.quantity is None
    wrong = defects_of_a_light(parsed.defects) if kind == "light" else parsed.defects
    step = f", step {parsed.step_nm:g} nm" if parsed.step_nm is not None else ""
    return [
        f"{what}: {count} {names}{more}, {curves.wavelength_nm[0]:g}-"
        f"{curves.wavelength_nm[-1]:g} nm{step}.",
        f"Values {curves.values.min():.4g} to {curves.values.max():.4g}, {parsed.scale}.",
        *(["Headed wavelength_nm, so taken as absolute QE per photon."] if own else []),
        *parsed.notes,
        *(f"Looks wrong: {defect}" for defect in wrong),
    ]


def _asks(parsed: ParsedSpectra, kind: str) -> list[Data]:
    asked = []
    for question in parsed.questions:
        key, choices = _ASKS.get(question.about, (None, []))
        if kind == "light":
            key = _OF_LIGHT.get(question.about)
            if question.about == "columns":
                key, choices = "column", list(parsed.curves.names)
        if key is not None:
            asked.append({"key": key, "question": question.asks, "choices": choices})
    return asked
