"""All that computes behind the page: imported in the background, once."""

import json
from typing import Any

from chromanoise.page.answers import Answers
from chromanoise.page.choices import choices
from chromanoise.page.pictures import Pictures
from chromanoise.page.previews import preview_of
from chromanoise.page.studies import Studies, files_of
from chromanoise.page.uploads import Uploads
from chromanoise.study.runs import study_from_data

STUDY: dict[str, Any] = {
    "light": {"illuminant": "E", "level_lux": 10.0},
    "exposure": {"equal": "exposure", "f_number": 1.8},
    "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}],
    "matrices": ["kernel"],
}
"""To start from: the paper's comparison."""


class Desk:
    """Answers, pictures and previews of one server.

    Parameters
    ----------
    uploads
        Its files.
    study
        To start from, as plain data.
    """

    def __init__(self, uploads: Uploads, *, study: dict[str, Any] | None = None) -> None:
        self._uploads, self._study = uploads, STUDY if study is None else study
        files = files_of(study_from_data(self._study, source="study"))
        self._studies = Studies(uploads, files=files)
        self.answers = Answers(self._studies)
        self.pictures = Pictures(self._studies)

    def choices(self) -> str:
        """The JSON of ``/api/choices``."""
        return json.dumps(choices() | {"study": self._study}, allow_nan=False)

    def previewed(self, name: str, content: bytes) -> dict[str, Any]:
        """A file kept, and the JSON of ``/api/upload``.

        Raises
        ------
        QuestionError
            If it is none that the page reads.
        """
        told = preview_of(self._uploads.keep(name, content))
        if told["study"] is not None:
            wrong = self._studies.complaints(told["study"])
            told["preview"] += [f"Looks wrong: {sentence}" for sentence in wrong]
        return told

    def warm(self) -> None:
        """Compute once what the page will ask first, so that its first answer is quick."""
        self.answers.answer({"study": self._study})
        self.choices()
