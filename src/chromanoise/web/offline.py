"""The page without a server: one function from the path and the body of a question to its reply."""

import traceback
from dataclasses import field

from chromanoise.base import dataclass
from chromanoise.web.page_questions import QuestionError, faults_json
from chromanoise.web.services import Services
from chromanoise.web.uploads import Uploads, label_of

JSON = "application/json"
ASKED = "/api/"
ONLY_INSTALLED = (".npz", ".npy", ".tif", ".tiff", ".h5", ".hdf5", ".nc", ".mat", ".xlsx")
"""Endings of files whose readers need another process, other libraries, or maps of files."""
PREPARED = ("choices", "story", "explanations")
"""Questions without a body, whose replies depend on nothing."""


@dataclass(frozen=True, kw_only=True)
class Reply:
    """What a question gets.

    Attributes
    ----------
    content
        The body.
    kind
        Media type.
    status
        As of HTTP.
    headers
        Further headers.
    """

    content: bytes
    kind: str = JSON
    status: int = 200
    headers: dict[str, str] = field(default_factory=dict)


class OfflinePage:
    """Answers to the questions of one page."""

    def __init__(self) -> None:
        self._uploads = Uploads()
        self._services = Services(self._uploads)

    def resume(self) -> None:
        """Make the folder of dropped files again, where a copy of the memory goes on."""
        self._uploads.make_folder()

    def reply(self, path: str, body: bytes = b"", file_name: str = "") -> Reply:
        """The reply to a question, also to one that is refused or fails.

        Parameters
        ----------
        path
            ``/api/answer`` and so on, as of the server.
        body
            JSON, or the content of a dropped file.
        file_name
            Name of the dropped file.
        """
        name = path.removeprefix(ASKED)
        try:
            return self._replied(name, body, file_name)
        except QuestionError as error:
            return Reply(content=faults_json(error.faults).encode("ascii"), status=error.status)
        except (ImportError, RecursionError, MemoryError) as error:
            return _unable(name, error)
        except Exception:
            traceback.print_exc()
            return _refused(f"the {name} could not be computed for this study", status=500)

    def _replied(self, name: str, body: bytes, file_name: str) -> Reply:
        services = self._services
        if name in PREPARED:
            return Reply(content=getattr(services, name)().encode())
        if name in ("answer", "texts"):
            return Reply(content=getattr(services, name)(body).encode())
        if name == "csv":
            return Reply(content=services.csv(body).encode(), kind="text/csv")
        if name == "upload":
            label = label_of(file_name)
            if label.lower().endswith(ONLY_INSTALLED):
                need = "cubes, MATLAB files and Excel tables need the installed program"
                raise QuestionError(("file", f"{label}: {need} (pip install chromanoise)"))
            upload = self._uploads.keep(file_name, body)
            return Reply(content=services.previewed(upload).encode())
        if name == "picture":
            png, summary = services.picture(body)
            headers = {"X-Chromanoise-Summary": summary}
            return Reply(content=png, kind="image/png", headers=headers)
        if name in ("report", "card"):
            with self._uploads.empty_folder() as folder:
                content, hashed = getattr(services, name)(body, folder)
            return Reply(
                content=content.encode() if isinstance(content, str) else content,
                kind="text/html" if name == "report" else "application/pdf",
                headers={"X-Chromanoise-Hash": hashed},
            )
        return _refused("not found", status=404)


def _unable(name: str, error: BaseException) -> Reply:
    """The reply where this copy of the program lacks something that the installed one has."""
    if isinstance(error, ImportError):
        return _refused(
            f"The {name} needs the installed program (pip install chromanoise): this page is "
            f"without {error.name or 'a library'}."
        )
    if isinstance(error, RecursionError):
        return _refused("The study is nested too deeply.")
    return _refused(f"The {name} needs more memory than this page has.")


def _refused(sentence: str, *, status: int = 200) -> Reply:
    return Reply(content=faults_json([("", sentence)]).encode("ascii"), status=status)
