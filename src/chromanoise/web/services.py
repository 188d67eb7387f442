"""The questions of the page and their answers, without a server."""

import json
from contextlib import suppress
from pathlib import Path
from typing import Any

from chromanoise.base import from_above
from chromanoise.charts import EXPLANATIONS, explanation_as_json
from chromanoise.imaging.denoising import DENOISING
from chromanoise.study import ExposurePart, LightPart, study_from_data
from chromanoise.web.answers import ChartReplies
from chromanoise.web.controls import choices
from chromanoise.web.page_questions import QuestionError, data_of
from chromanoise.web.page_studies import Studies, files_of
from chromanoise.web.previews import PictureReplies, preview_of
from chromanoise.web.story import story
from chromanoise.web.uploads import Kept, Upload

STUDY: dict[str, Any] = {
    "light": LightPart().model_dump(include={"illuminant", "level_lux"}),
    "exposure": ExposurePart().model_dump(include={"equal", "f_number"}),
    "sensors": [{"name": "onyx-rgbw"}, {"name": "onyx-rgb-ircut"}],
    "matrices": ["kernel"],
    "pictures": [{"cube": "builtin:checker", "clip": True}],
}
"""The default study: the paper's comparison, with a picture that full wells clip."""


class Services:
    """Answers, pictures and previews of one server.

    Parameters
    ----------
    study
        The initial study as plain data.
    """

    def __init__(self, uploads: Kept, *, study: dict[str, Any] | None = None) -> None:
        self.uploads, self._study = uploads, STUDY if study is None else study
        files = files_of(study_from_data(self._study, source="study", keep_idle=True))
        self._studies = Studies(uploads, files=files)
        self._answers = ChartReplies(self._studies)
        self._pictures = PictureReplies(self._studies)
        self._prepared: set[str | None] = set()
        self._story: str | None = None

    def choices(self, has_front: bool = False) -> str:
        """The JSON of ``/api/choices``; ``has_front``: whether ``/api/front`` has a front."""
        served = {"study": self._study, "front": has_front}
        return json.dumps(choices() | served, allow_nan=False)

    def story(self) -> str:
        """The JSON of ``/api/story``."""
        if self._story is None:
            self._story = json.dumps(story(STUDY), allow_nan=False)
        return self._story

    def explanations(self) -> str:
        """The JSON of ``/api/explanations``."""
        return json.dumps({key: explanation_as_json(key) for key in EXPLANATIONS})

    def answer(self, body: bytes) -> str:
        """The JSON of ``/api/answer``.

        Raises
        ------
        QuestionError
            With all faults of the question; also for the other methods.
        """
        return self._answers.answer(data_of(body))

    def csv(self, body: bytes) -> str:
        """The CSV of ``/api/csv``."""
        return self._answers.csv(data_of(body))

    def report(self, body: bytes, folder: Path) -> tuple[str, str]:
        """The HTML of ``/api/report`` and the hash of its study; its files go into ``folder``."""
        return from_above("saved_files").report_reply(self._studies, data_of(body), folder)

    def card(self, body: bytes, folder: Path) -> tuple[bytes, str]:
        """The PDF of ``/api/card``, as `report`."""
        return from_above("saved_files").card_reply(self._studies, data_of(body), folder)

    def texts(self, body: bytes) -> str:
        """The JSON of ``/api/texts``."""
        return json.dumps(self._answers.texts(data_of(body)))

    def picture(self, body: bytes) -> tuple[bytes, str]:
        """The PNG of ``/api/picture``, and its summary as JSON."""
        return self._pictures.picture(data_of(body))

    def previewed(self, upload: Upload) -> str:
        """The JSON of ``/api/upload``."""
        preview = preview_of(upload)
        if preview["study"] is not None:
            wrong = self._studies.complaints(preview["study"])
            preview["preview"] += [f"Looks wrong: {sentence}" for sentence in wrong]
        return json.dumps(preview)

    def prepare(self, name: str, *given: Any) -> None:
        """Do the one-time preparation of a job, which must not count against its time limit.

        Parameters
        ----------
        name, given
            One of its methods, and the arguments. Some pictures compile kernels, which takes up to
            minutes on a busy machine.
        """
        if name == "picture":
            methods = (None, *_denoising_of(given[0])[:1])
        elif name == "report":
            methods = (None, *_denoising_of(given[0]))  # it begins with a card, which has pictures
        elif name == "card":
            methods = (None,)
        else:
            return
        for method in methods:
            if method in self._prepared:
                continue
            with suppress(QuestionError):  # of the page's own study: not a fault of the one asked
                self._pictures.picture({"study": STUDY | {"pictures": [{"denoise": method}]}})
                self._prepared.add(method)

    def warm(self) -> None:
        """Compute in advance what most requests need.

        Only the default study is used, because time and memory are not limited here.
        """
        self._answers.answer({"study": STUDY})
        self.choices()
        self.story()


def _denoising_of(body: bytes) -> tuple[str | None, ...]:
    """The known denoising method of each picture of the study in a question; `None` for none."""
    with suppress(QuestionError, LookupError, TypeError):  # reported by the question itself
        parts = data_of(body)["study"]["pictures"]
        methods = [part.get("denoise") for part in parts if isinstance(part, dict)]
        return tuple(one for one in methods if one is None or one in DENOISING)
    return ()
