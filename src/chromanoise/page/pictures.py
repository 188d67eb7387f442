"""Render a cube with one sensor to a picture in memory, with or without noise."""

import json
import math
import zipfile
from collections.abc import Mapping
from typing import Any

from chromanoise.analysis.color_matrices import matrix_makers
from chromanoise.catalog.resolve import file_of
from chromanoise.denoising import DENOISING, captured_with
from chromanoise.errors import InputError
from chromanoise.exposure import OperatingPoint
from chromanoise.imaging import Work
from chromanoise.imaging.capture import camera_for
from chromanoise.imaging.writers import picture_summary, png_bytes
from chromanoise.io.cubes.errors import reading
from chromanoise.page.cache import Remembered
from chromanoise.page.requests import QuestionError, field, malformed, page_sentence
from chromanoise.page.studies import Studies, spoken, stamps_of
from chromanoise.page.uploads import Upload
from chromanoise.scene import Cube
from chromanoise.scene.rows import row_source
from chromanoise.study import Study
from chromanoise.study.assembly import cube_of, with_distinct_names
from chromanoise.study.document import PicturePart
from chromanoise.study.hashes import FileWord
from chromanoise.study.pictures import capture_settings_of

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
    method = DENOISING[part.denoise] if part.denoise is not None and noisy else None
    work = Work(threads=1)
    picture = captured_with(cube, camera, method, frame=0, work=work, noisy=noisy).picture
    assert picture is not None  # no picture without color is requested
    summary = picture_summary(picture)
    if part.mosaic is not None:
        note = f"all channels at every pixel; a run takes it through its mosaic {part.mosaic}"
        summary["notes"] = [*summary["notes"], note]
    return png_bytes(picture.srgb), json.dumps(summary)
