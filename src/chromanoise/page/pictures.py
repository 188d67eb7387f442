"""A cube through one sensor as a picture in memory, with or without its noise."""

import json
import math
import zipfile
from collections.abc import Mapping
from typing import Any

from chromanoise._check import InputError
from chromanoise.exposure import Situation
from chromanoise.imaging import Work, rendered
from chromanoise.imaging.writers import picture_summary, png_bytes
from chromanoise.page.asked import QuestionError, field
from chromanoise.page.remembered import Remembered
from chromanoise.page.studies import Studies, spoken
from chromanoise.page.uploads import Upload, Uploads
from chromanoise.scene import Cube, builtin_cube, read_cube
from chromanoise.scene.rows import row_source
from chromanoise.study.makers import matrix_makers
from chromanoise.study.runs import Study

MOST_VALUES = 64_000_000
_BUILTIN = "builtin:checker"
_UNPACKED_BYTES = 512_000_000


class Pictures:
    """Cubes that were asked for lately, and the latest pictures of them."""

    def __init__(self, studies: Studies, uploads: Uploads) -> None:
        self._studies, self._uploads = studies, uploads
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
        situations = self._studies.situations(study, used)
        if not 0 <= which < len(situations):
            raise QuestionError(
                ("sensor", f"the study has no sensor {which}; counting starts at 0")
            )
        word = question.get("cube") or _BUILTIN
        if not isinstance(word, str):
            raise QuestionError(("cube", "cube must be the id of an upload, a scene, or null"))
        situation = situations[which]
        key = (word, noisy, situation.sensor, study.model_dump_json(exclude={"outputs", "sweeps"}))
        try:
            return self._taken.of(
                key, lambda: _taken(self._cube(word, used), study, situation, noisy=noisy)
            )
        except InputError as error:
            raise QuestionError(("cube", spoken(str(error), used))) from None

    def _cube(self, word: str, used: list[Upload]) -> Cube:
        if word.startswith("builtin:"):
            return self._cubes.of(word, lambda: builtin_cube(word))
        found = self._uploads.named(word)
        if found is None or found.kind not in ("cube", "either"):
            raise QuestionError(("cube", f"{word[:80]!r}: drop the file of a cube onto the page"))
        used.append(found)
        return self._cubes.of(word, lambda: cube_of_upload(found))


def cube_of_upload(upload: Upload) -> Cube:
    """The cube in a file that was dropped, if it is of a size for a page.

    Raises
    ------
    InputError
        If it holds no cube, or too large a one; a packed file is asked for its size first.
    """
    if zipfile.is_zipfile(upload.path):
        with zipfile.ZipFile(upload.path) as packed:
            size = sum(one.file_size for one in packed.infolist())
        if size > _UNPACKED_BYTES:
            raise InputError(
                f"{upload.label}: unpacks to {size / 1e6:.0f} MB; the page takes "
                f"{_UNPACKED_BYTES / 1e6:g} MB, chromanoise simulate any size"
            )
    cube = read_cube(upload.path)
    values = math.prod(row_source(cube.stored).shape)
    if values > MOST_VALUES:
        raise InputError(
            f"{upload.label}: {values} reflectances; the page takes {MOST_VALUES}, chromanoise "
            "simulate any number"
        )
    return cube


def _taken(cube: Cube, study: Study, situation: Situation, *, noisy: bool) -> tuple[bytes, str]:
    makers = matrix_makers(study.matrices[:1], study.metric, prior=study.prior)  # type: ignore[arg-type]
    (maker,) = makers.values()
    picture = rendered(
        cube,
        situation,
        matrix=maker(situation),
        seed=study.seed,
        noisy=noisy,
        beyond="hold",
        work=Work(threads=1),
    )
    return png_bytes(picture.srgb), json.dumps(picture_summary(picture))
