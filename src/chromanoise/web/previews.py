"""Previews of uploaded files: how a file was parsed, and which metadata it lacks.

Files are curves, cubes and studies; a front, with the data that load its members; and, for a sensor
or a study, crosstalk, a color matrix, a pixel and pairs. A cube is rendered with one sensor to a
picture in memory, with or without noise.
"""

import json
import math
import re
import zipfile
from collections.abc import Mapping
from dataclasses import fields
from pathlib import PurePosixPath
from typing import Any

from chromanoise.apps.design import FRONT_SCHEMA, FrontMember, drawn_front, member_csv, read_front
from chromanoise.base import InputError, Setting, StudyError, check, errors_in
from chromanoise.imaging import Work, camera_for, picture_summary, png_bytes
from chromanoise.imaging.denoising import captured_with, denoising_named
from chromanoise.io import GivenMatrix, crosstalk_table, is_matrix_file, read_curves, read_matrix
from chromanoise.io.cubes import reading
from chromanoise.io.spectra import ParsedSpectra, defects_of_a_light
from chromanoise.noise import OperatingPoint
from chromanoise.sensor import PixelSource
from chromanoise.spectra import DEFAULT_GRID, Cube, Spectra, row_source
from chromanoise.study import (
    PAIRS_HEADER,
    FileWord,
    PicturePart,
    Study,
    capture_settings_of,
    cube_of,
    file_of,
    matrix_makers,
    own_sensor_of,
    read_pixel_source,
    resolve_pairs,
    study_from_text,
    with_distinct_names,
)
from chromanoise.web.page_questions import QuestionError, field, malformed, page_sentence
from chromanoise.web.page_studies import Remembered, Studies, served_data, spoken, stamps_of
from chromanoise.web.uploads import Upload, in_words

MOST_VALUES = 64_000_000
_UNPACKED_BYTES = 512_000_000
_OF_CUBE = {"cube", "key", "shape", "wavelengths", "scale"}
_BESIDE = {"outputs", "sweeps", "pictures", "title"}


class PictureReplies:
    """Render pictures, with caches of recent cubes and pictures."""

    def __init__(self, studies: Studies) -> None:
        self._studies = studies
        self._cubes: Remembered[Cube] = Remembered(2)
        self._taken: Remembered[tuple[bytes, str]] = Remembered(16)

    def picture(self, question: Mapping[str, Any]) -> tuple[bytes, str]:
        """The PNG of ``/api/picture``, and its summary as JSON.

        Raises
        ------
        QuestionError
            With all faults of the question.
        """
        study, used = self._studies.read(field(question, "study", dict, {}))
        noisy, which = field(question, "noisy", bool, True), field(question, "sensor", int, 0)
        operating_points = self._studies.operating_points(study, used)
        if not 0 <= which < len(operating_points):
            raise QuestionError(
                ("sensor", f"the study has no sensor {which}; counting starts at 0")
            )
        where, part = self._part(study, question.get("cube"), used)
        nouns = (operating_points[which].sensor, operating_points[which].illuminant)
        operating_point = with_distinct_names(operating_points)[which]
        try:
            stamps = stamps_of(study.model_copy(update={"pictures": (part,)}), "pictures.")
            about = (part.model_dump_json(include=_OF_CUBE), stamps)
            cube = self._cubes.of(about, lambda: bounded_cube(part))
            words = (part.model_dump_json(), study.model_dump_json(exclude=_BESIDE), stamps)
            png, summary = self._taken.of(
                (noisy, operating_point.sensor.name, nouns, *words),
                lambda: _taken(cube, part, study, operating_point, noisy=noisy),
            )
        except InputError as error:
            raise QuestionError((where, spoken(page_sentence(error), used))) from None
        return png, spoken(summary, used)

    def _part(self, study: Study, cube: Any, used: list[Upload]) -> tuple[str, PicturePart]:
        """The key and the settings of the picture: the study's first picture, or another cube."""
        if cube is not None and not isinstance(cube, str):
            raise malformed("cube", "cube must be the id of an upload, a scene, or null")
        own = study.pictures[0] if study.pictures else PicturePart()
        word = own.cube
        if cube:
            word = self._studies.word(FileWord(where="cube", kind="cube", word=cube), used)
        part = own if word == own.cube else PicturePart(cube=word)
        if "beyond" not in part.model_fields_set:  # the notes report this default
            part = part.model_copy(update={"beyond": "hold"})
        return "cube" if cube else "pictures.0.cube", part


def cube_of_upload(upload: Upload) -> Cube:
    """The cube in an uploaded file, if the page accepts its size.

    Raises
    ------
    InputError
        As `bounded_cube`.
    """
    return bounded_cube(PicturePart(cube=str(upload.path)))


def bounded_cube(part: PicturePart) -> Cube:
    """The cube of a picture, if the page accepts its size.

    Raises
    ------
    InputError
        If the file holds no cube, or one that is too large. The size of a packed file is checked
        before it is unpacked.
    """
    path = file_of(part.cube)
    if not part.cube.startswith("builtin:") and path.is_file() and zipfile.is_zipfile(path):
        with reading(path, "NumPy"), zipfile.ZipFile(path) as packed:
            size = sum(one.file_size for one in packed.infolist())
        if size > _UNPACKED_BYTES:
            raise InputError(
                str(path),
                f"must unpack to at most {_UNPACKED_BYTES / 1e6:g} MB on the page",
                value=size,
                found=f"unpacks to {size / 1e6:.0f} MB",
                remedy="render it with `chromanoise simulate`, which takes any size",
            )
    cube = cube_of(part)
    values = math.prod(row_source(cube.stored).shape)
    if values > MOST_VALUES:
        raise InputError(
            str(path),
            f"must hold at most {MOST_VALUES} reflectances on the page",
            value=values,
            found=f"holds {values}",
            remedy="render it with `chromanoise simulate`, which takes any number",
        )
    return cube


def _taken(
    cube: Cube, part: PicturePart, study: Study, operating_point: OperatingPoint, *, noisy: bool
) -> tuple[bytes, str]:
    makers = matrix_makers(study.matrices[:1], study.metric, prior=study.prior)  # type: ignore[arg-type]
    (maker,) = makers.values()
    color = part.model_copy(update={"mosaic": None, "formats": None})
    settings = capture_settings_of(color, seed=study.seed)
    camera = camera_for(cube, operating_point, maker(operating_point), settings)
    method = denoising_named(part.denoise) if part.denoise is not None and noisy else None
    work = Work(threads=1)
    picture = captured_with(cube, camera, method, frame=0, work=work, noisy=noisy).picture
    assert picture is not None  # no picture without color is requested
    summary = picture_summary(picture)
    if part.mosaic is not None:
        note = f"all channels at every pixel; a run takes it through its mosaic {part.mosaic}"
        summary["notes"] = [*summary["notes"], note]
    return png_bytes(picture.srgb), json.dumps(summary)


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

_HEAD_BYTES = 2000
_MATRIX_KEYS = (b"matrix_lux_per_e", b"balanced", b"CameraToXYZ", b"ColorMatrix1")
_NO_TABLE = "must have at least 2 rows of a wavelength and a value"
_PIXEL_SCHEMA = re.compile(r"(?m)^[ \t]*schema[ \t]*=[ \t]*[\"']")
_STUDY_KEY = re.compile(rf"(?m)^[ \t]*\[*[ \t]*(?:{'|'.join((*Study.model_fields, 'schema'))})\b")

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
    return _answer(upload, preview) | {
        "study": preview.get("study"),
        "front": preview.get("front"),
        "others": [_answer(upload, one) for one in preview.get("others", ())],
    }


def _answer(upload: Upload, preview: Data) -> Data:
    lines = [in_words(line, upload) for line in preview["preview"]]
    asks = preview.get("asks", [])
    return {"kind": preview["kind"], "id": upload.id, "preview": lines, "asks": asks}


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
    if upload.kind == "toml":
        return _toml(upload)
    if upload.kind == "matrix":
        return matrix_preview(upload)
    if upload.kind == "cube":
        return _cube(upload)
    if upload.kind == "either":
        try:
            _refuse_large_table(upload)
            return _spectra(upload)
        except InputError:
            return _cube(upload)
    return _table(upload)


def _table(upload: Upload) -> Data:
    """A file of numbers: what each reader takes it for; ``others`` if more than one reads it."""
    if is_front(upload):
        return front_preview(upload)
    if is_pairs(upload):
        return pairs_preview(upload)
    _refuse_large_table(upload)
    found: list[Data] = []
    errors: list[InputError] = []
    for make in (_spectra, crosstalk_preview, matrix_preview, pixel_preview):
        try:
            found.append(make(upload))
        except InputError as error:
            errors.append(error)
    if not found:
        raise _of_none(upload, errors)
    first, *others = found
    return first | {"others": others}


def _of_none(upload: Upload, errors: list[InputError]) -> InputError:
    """The error of the reader that the content points to."""
    spectra, crosstalk, matrix, pixel = errors
    text = upload.path.read_bytes()[:_HEAD_BYTES].lstrip()
    if text.startswith(b"<") and b"ProcessList" in text:
        return matrix
    if any(key in text for key in _MATRIX_KEYS) and text.startswith(b"{"):
        return matrix
    if b"lx/e-," in text:
        return matrix
    if text.startswith(b"{") and spectra.requirement == matrix.requirement:  # of JSON as such
        return spectra
    if text.startswith(b"{") and b'"S"' in text and b'"O"' in text:
        return pixel
    if crosstalk.subject.startswith("crosstalk"):  # of its numbers, not of its form
        return crosstalk
    if spectra.requirement != _NO_TABLE and not text.startswith(b"{"):
        return spectra
    return InputError(
        upload.label,
        "must hold spectra, a sensor, crosstalk, a color matrix or the values of a pixel",
        found="holds none of them",
    )


def _toml(upload: Upload) -> Data:
    """A pixel if the schema is a text, else a study, whose schema is a number."""
    _refuse_large(upload, _MOST_STUDY_BYTES, "a study")
    try:
        text = upload.path.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(
            upload.label, "is not a UTF-8 text file", remedy="save the file as UTF-8"
        ) from None
    if _PIXEL_SCHEMA.search(text):
        return pixel_preview(upload)
    if not _STUDY_KEY.search(text):
        raise InputError(
            upload.label,
            'must be a study, or a pixel with schema = "chromanoise pixel"',
            found="has no key of either",
        )
    return _study(upload, text)


def _study(upload: Upload, text: str) -> Data:
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


def _refuse_large_table(upload: Upload) -> None:
    remedy = "keep one row per nanometer"
    _refuse_large(upload, MOST_SPECTRUM_BYTES, "spectra on the page", remedy=remedy)


def _refuse_large(upload: Upload, most_bytes: int, what: str, **remedy: str) -> None:
    if upload.size_bytes > most_bytes:
        raise InputError(
            upload.label,
            f"must have at most {most_bytes / 1e6:g} MB, as {what}",
            value=upload.size_bytes,
            found=f"has {upload.size_bytes / 1e6:.1f} MB",
            **remedy,
        )


def _spectra(upload: Upload) -> Data:
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


def is_front(upload: Upload) -> bool:
    """Whether a file declares the schema of a front."""
    if not upload.path.is_file():
        return False
    with upload.path.open("rb") as file:
        return f'"{FRONT_SCHEMA}"'.encode() in file.read(_HEAD_BYTES)


def front_preview(upload: Upload) -> dict[str, Any]:
    """The content of a front: ``chart``, ``scenes``, and by name the ``members`` with their curves.

    Raises
    ------
    InputError
        If the front or the curves of a member are invalid.
    """
    front = read_front(upload.path)
    sensors = f"{len(front.members)} sensor{'' if len(front.members) == 1 else 's'}"
    objectives = ", ".join(one.what for one in front.objectives)
    return {
        "kind": "front",
        "preview": [f"A front of {sensors}: {objectives}.", *front.sentences],
        "front": {
            "chart": drawn_front(front),
            "scenes": [one.model_dump(mode="json") for one in front.scenes],
            "members": {one.name: _member(one) for one in front.members},
        },
    }


def _member(member: FrontMember) -> dict[str, Any]:
    return {
        "file": f"{PurePosixPath(member.sensor).stem or member.name}.csv",
        "text": member_csv(member),
        **member.model_dump(mode="json", include={"pixel", "exposure", "matrix"}),
    }


_NOT_SHOWN = ("source", "notes", "adc")
_FROM = {"electrons": "raw electrons", "balanced": "white-balanced raw", "from-xyz": "XYZ"}


def crosstalk_preview(upload: Upload) -> Data:
    """What a file of crosstalk holds.

    Raises
    ------
    InputError
        If it is no table of shares of light.
    """
    table = crosstalk_table(upload.path)
    check.fraction(f"crosstalk of {upload.label}", "1", table.values)
    rows, columns = table.values.shape
    if table.columns:
        line = f"Crosstalk between the channels {', '.join(table.columns)}."
    elif rows == columns and rows % 2:
        line = f"A crosstalk kernel of {rows} x {columns} pixels, for a sensor with a mosaic."
    else:
        raise InputError(
            upload.label,
            "must have as many rows as columns, an odd number, to be a crosstalk kernel",
            value=table.values.shape,
        )
    return {"kind": "crosstalk", "preview": [line]}


def is_pairs(upload: Upload) -> bool:
    """Whether the file is a list of pairs of patches, which its header tells."""
    with upload.path.open("rb") as file:
        start = file.readline(200).decode("utf-8-sig", errors="replace")
    return tuple(word.strip().lower() for word in start.split(",")) == PAIRS_HEADER


def pairs_preview(upload: Upload) -> Data:
    """What a list of pairs of patches holds.

    Raises
    ------
    InputError
        If a line does not name two known patches.
    """
    count = len(resolve_pairs(str(upload.path)).indices)
    return {"kind": "pairs", "preview": [f"Pairs of patches for a machine: {count}."]}


def matrix_preview(upload: Upload) -> Data:
    """What a file of a color matrix holds.

    Raises
    ------
    InputError
        If it holds none.
    """
    if not is_matrix_file(upload.label):
        raise InputError(upload.label, "must have the ending of a color matrix, e.g. .csv or .json")
    found = read_matrix(upload.path)
    rows, columns = found.values.shape
    line = f"A color matrix, {rows} x {columns}: {_FROM[found.kind]} to {_target(found)}"
    return {"kind": "matrix", "preview": [f"{line}{_made_for(found)}.", *found.notes]}


def _target(found: GivenMatrix) -> str:
    if found.kind == "from-xyz":
        return "camera values"
    return "XYZ [lx/e-]" if found.kind == "electrons" else found.target


def _made_for(found: GivenMatrix) -> str:
    level = "" if found.level_lux is None else f"{found.level_lux:g} lx"
    kelvin = "" if found.kelvin is None else f"{found.kelvin:g} K"
    known = [one for one in (found.sensor, found.illuminant, level, kelvin) if one]
    channels = f"; channels {', '.join(found.channels)}" if found.channels else ""
    return f"{channels}; made for {', '.join(known)}" if known else channels


def pixel_preview(upload: Upload) -> Data:
    """What a file with the values of a pixel holds.

    Raises
    ------
    InputError
        If it holds none.
    """
    found = read_pixel_source(upload.path)
    known = _known_values(found)
    line = f"The values of a pixel: {', '.join(known) or 'none that a sensor takes'}."
    return {"kind": "pixel", "preview": [line, *found.notes]}


def _known_values(source: PixelSource) -> list[str]:
    own = [one.name for one in fields(source) if one.name not in _NOT_SHOWN]
    known = {name: getattr(source, name) for name in own}
    return [f"{name} = {value:.6g}" for name, value in known.items() if value is not None]
