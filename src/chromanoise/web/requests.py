"""Requests to the page: access checks, parsing, uploads, and the files of the page.

Only this page in a browser on this machine is accepted. Requests are JSON of bounded size, with
checks of the types of values. The drawing modules of the figures are served as the folder ``draw``.
Uploaded files are stored temporarily under generated names.
"""

import asyncio
import base64
import hashlib
import json
import re
import shutil
import tempfile
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from chromanoise.base import InputError, Setting, json_of, palette_css

JSON_BYTES = 1_000_000
UPLOAD_BYTES = 12_000_000

_FIXED = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}


def own_hosts(port: int) -> frozenset[str]:
    """What a browser calls us; any other name leads here by somebody's trick with DNS.

    Examples
    --------
    >>> sorted(own_hosts(8421))
    ['127.0.0.1:8421', '[::1]:8421', 'localhost:8421']
    """
    return frozenset(f"{name}:{port}" for name in ("localhost", "127.0.0.1", "[::1]"))


def refusal(scope: Scope, hosts: frozenset[str]) -> str | None:
    """Why a request is not of this page; ``None`` where it is.

    Parameters
    ----------
    scope
        Of an HTTP request.
    """
    headers = Headers(scope=scope)
    if headers.getlist("host") != [host := headers.get("host", "")] or host.lower() not in hosts:
        return f"this server answers to localhost only, not to {host[:80]!r}"
    origin = headers.get("origin")
    if origin is not None and origin.lower() != f"http://{host.lower()}":
        return "requests from other sites are refused"
    if headers.get("sec-fetch-site") in ("cross-site", "same-site") and not _is_opened(scope):
        return "requests from other sites are refused"
    return None


def _is_opened(scope: Scope) -> bool:
    """A link to the page that somebody followed: it shows, and tells nothing to whoever linked."""
    headers = Headers(scope=scope)
    shown = (headers.get("sec-fetch-mode"), headers.get("sec-fetch-dest"))
    return scope["method"] == "GET" and scope["path"] == "/" and shown == ("navigate", "document")


def inline_hashes(html: bytes) -> list[str]:
    """CSP sources of the scripts that stand in the page itself: the import map.

    Examples
    --------
    >>> inline_hashes(b'<script type="importmap">{}</script><script src="a.js"></script>')
    ["'sha256-RBNvo1WzZ4oRRq0W9+hknpT7T8If536DEMBg9hyq/4o='"]
    """
    inline = re.findall(rb"<script(?![^>]*\bsrc=)[^>]*>(.*?)</script>", html, re.DOTALL)
    digests = (base64.b64encode(hashlib.sha256(text).digest()).decode() for text in inline)
    return [f"'sha256-{digest}'" for digest in digests]


def content_policy(html: bytes) -> str:
    """What the page may load: its own files, and nothing from outside."""
    scripts = " ".join(["'self'", *inline_hashes(html)])
    return (
        f"default-src 'none'; script-src {scripts}; style-src 'self'; img-src 'self' data: blob:; "
        "font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
        "frame-ancestors 'none'"
    )


def guarded(app: ASGIApp, *, port: int, policy: Callable[[], str]) -> ASGIApp:
    """The application behind the checks of `refusal`, each answer with the headers that it needs.

    Parameters
    ----------
    port
        On which it listens.
    policy
        Of content, as `content_policy`.
    """
    hosts = own_hosts(port)

    async def checked(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            if scope["type"] == "lifespan":
                await app(scope, receive, send)
            return

        async def sent(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in (_FIXED | {"Content-Security-Policy": policy()}).items():
                    headers[name] = value
                if scope["path"].startswith("/api"):
                    headers["Cache-Control"] = "no-store"
            await send(message)

        why = refusal(scope, hosts)
        if why is not None:
            reply = fault_reply(403, why)
            reply.headers["Connection"] = "close"  # its body is not read
            await reply(scope, receive, sent)
            return
        await app(scope, receive, sent)

    return checked


class AsciiJSONResponse(JSONResponse):
    """JSON with escapes for all other characters; unpaired surrogates cannot be sent otherwise."""

    def render(self, content: Any) -> bytes:
        """The bytes of the body."""
        return json.dumps(content, allow_nan=False).encode("ascii")


def fault_reply(status: int, sentence: str, *, where: str = "") -> JSONResponse:
    """One fault as every answer of the server tells it."""
    return AsciiJSONResponse(
        {"faults": [{"where": where, "sentence": sentence}]}, status_code=status
    )


_TYPES = {
    "css": "text/css",
    "html": "text/html",
    "js": "text/javascript",
    "json": "application/json",
    "png": "image/png",
    "svg": "image/svg+xml",
    "txt": "text/plain",
}
_STEP = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9_.-]{0,99}")  # no parent folder, no hidden file
_LONGEST_PATH = 200  # a system may raise an error for a longer one
_INDEX = "index.html"
_OWN, _DRAW = "web/assets", "charts/draw"  # the second is shared with the report
_COLORED = "draw/draw.css"


def asset(path: str) -> bytes | None:
    """The content of a file of the page; ``None`` if it does not exist.

    Examples
    --------
    >>> asset("../__init__.py") is None
    True
    """
    steps = path.split("/")
    known = path.rpartition(".")[2] in _TYPES and all(_STEP.fullmatch(step) for step in steps)
    if not known or len(path) > _LONGEST_PATH:
        return None
    shared = steps[0] == "draw"
    place: Traversable = files("chromanoise").joinpath(_DRAW if shared else _OWN)
    for step in steps[1:] if shared else steps:
        place = place.joinpath(step)
    if not place.is_file():
        return None
    palette = palette_css().encode("utf-8") if path == _COLORED else b""
    return palette + place.read_bytes()


def page_policy() -> str:
    """The content policy of the page."""
    return content_policy(asset(_INDEX) or b"")


async def index(request: Request) -> Response:
    """The page."""
    return _reply(request, _INDEX)


async def asset_reply(request: Request) -> Response:
    """A file of the page."""
    return _reply(request, request.path_params["path"])


def _reply(request: Request, path: str) -> Response:
    content = asset(path)
    if content is None:
        return fault_reply(404, f"the page has no file {path[:80]!r}")
    tag = f'"{hashlib.sha256(content).hexdigest()[:32]}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    kind = _TYPES[path.rpartition(".")[2]]
    charset = "" if kind == "image/png" else "; charset=utf-8"
    return Response(content, headers=headers | {"Content-Type": kind + charset})


_PATIENCE_S = 30.0
_PASSED_OVER_BYTES = 32_000_000
_LONGEST_LENGTH = 18  # digits of a Content-Length that may be a number of bytes
_MOST_COMING_BYTES = 64_000_000  # of all bodies being received
_REST_S = 5.0  # longest time between two chunks of a body


class QuestionError(Exception):
    """A request that is refused with messages, each with the key it refers to.

    Attributes
    ----------
    faults
        Pairs of where (``sensors.0.name``) and sentence.
    status
        HTTP status; 200 if a well-formed request contains an invalid value, because browsers log
        every other status as an error of the page.
    unread
        Whether the body is not read yet: the reply is sent first, then the body is discarded.
    """

    def __init__(self, *faults: tuple[str, str], status: int = 200, unread: bool = False) -> None:
        super().__init__("; ".join(sentence for _, sentence in faults))
        self.faults, self.status, self.unread = faults, status, unread


def page_sentence(error: InputError) -> str:
    """The sentence of an error in the terms of the page, whose controls have the names of settings.

    Parameters
    ----------
    error
        Of the library, or one of a study.
    """

    def rendered(setting: Setting) -> str:
        name = setting.name.rpartition(".")[2].replace("_", " ")
        if setting.omit:
            return f"omit {name}"
        values = " or ".join(map(str, setting.values))
        return f"set {name} to {values}" if values else f"set {name}"

    subject = error.subject
    if error.setting and subject == error.setting_name:
        subject = subject.replace("_", " ")
    return error.sentence(subject=subject, render=rendered)


def malformed(where: str, sentence: str) -> QuestionError:
    """The error for a malformed request, which the page never sends."""
    return QuestionError((where, sentence), status=400)


@dataclass(slots=True, eq=False)
class _Coming:
    patience: asyncio.Timeout
    latest_s: float
    length: int = 0


class Bodies:
    """Request bodies being received.

    If they hold too many bytes together, the one that has waited longest for a chunk is dropped.
    """

    def __init__(self) -> None:
        self._coming: list[_Coming] = []

    async def body_of(self, request: Request, *, most_bytes: int) -> bytes:
        """The body, read in chunks and refused as soon as it is too long.

        Parameters
        ----------
        most_bytes
            Largest size of the body.

        Raises
        ------
        QuestionError
            If it is too long, or does not arrive in time.
        """
        length = request.headers.get("content-length", "")
        known = length.isascii() and length.isdecimal()
        if known and (len(length) > _LONGEST_LENGTH or int(length) > most_bytes):
            raise _too_long(most_bytes, unread=True)
        try:
            async with asyncio.timeout(_PATIENCE_S) as patience:
                pieces = await self._pieces(request, most_bytes, patience)
        except TimeoutError:
            sentence = "the request did not arrive in time; send it again"
            raise QuestionError(("", sentence), status=408) from None
        if pieces is None:
            await passed_over(request.receive)
            raise _too_long(most_bytes)
        return b"".join(pieces)

    async def _pieces(
        self, request: Request, most_bytes: int, patience: asyncio.Timeout
    ) -> list[bytes] | None:
        """The chunks received; None if the body is too long."""
        now = asyncio.get_running_loop().time
        end, pieces = now() + _PATIENCE_S, []
        one = _Coming(patience, now())
        self._coming.append(one)
        try:
            patience.reschedule(now() + _REST_S)
            async for piece in request.stream():
                one.length += len(piece)
                if one.length > most_bytes:
                    return None
                pieces.append(piece)
                one.latest_s = now()
                patience.reschedule(min(one.latest_s + _REST_S, end))
                self._make_room(one)
        finally:
            self._coming.remove(one)
        return pieces

    def _make_room(self, latest: _Coming) -> None:
        over = sum(one.length for one in self._coming) - _MOST_COMING_BYTES
        for one in sorted(self._coming, key=lambda one: one.latest_s):
            if over > 0 and one is not latest and not one.patience.expired():
                one.patience.reschedule(0)  # it times out at once
                over -= one.length


def data_of(body: bytes) -> dict[str, Any]:
    """The JSON object in a body.

    Raises
    ------
    QuestionError
        If it is none, or as `json_of`.
    """
    try:
        data = json_of(body, "the request")
    except InputError as error:
        raise malformed("", str(error)) from None
    if not isinstance(data, dict):
        raise malformed("", f"the request must be a JSON object, but is a {_kind(data)}")
    return data


def refuse_long_lists(data: Mapping | list, where: str = "") -> None:
    """Refuse a study in which a list or an object has more entries than the page accepts.

    Raises
    ------
    QuestionError
        If there is one, or the study is nested too deeply.
    """
    if where.count(".") > _DEEPEST:
        raise malformed(where[:80], f"{where[:80]} is nested too deeply for a study")
    inside = data.items() if isinstance(data, dict) else enumerate(data)
    if len(data) > MOST_ENTRIES:
        raise malformed(
            where, f"{where or 'the study'} has {len(data)} entries; the limit is {MOST_ENTRIES}"
        )
    for key, value in inside:
        if isinstance(value, dict | list):
            refuse_long_lists(value, f"{where}.{key}" if where else str(key))


def field(data: Mapping[str, Any], name: str, kind: type, default: Any) -> Any:
    """One value of a question, of the kind that it must have.

    Raises
    ------
    QuestionError
        If it is of another kind.
    """
    value = data.get(name, default)
    if value is not default and (
        not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)
    ):
        raise malformed(name, f"{name} must be a JSON {_NAMES[kind]}, but is a {_kind(value)}")
    return value


MOST_ENTRIES = 64
_DEEPEST = 12
_NAMES = {
    dict: "object",
    list: "list",
    str: "string",
    int: "whole number",
    float: "number",
    bool: "truth value",
    type(None): "null",
}


def _kind(value: Any) -> str:
    return _NAMES.get(type(value), "value")


def _too_long(most_bytes: int, *, unread: bool = False) -> QuestionError:
    message = f"the request exceeds the limit of {most_bytes / 1e6:g} MB"
    return QuestionError(("", message), status=413, unread=unread)


async def passed_over(receive: Receive) -> None:
    """Discard the rest of a body up to a limit, because a client may miss a reply while it sends.

    Parameters
    ----------
    receive
        Of a request whose body is not read to its end.
    """
    length = 0
    try:
        async with asyncio.timeout(_PATIENCE_S):
            while length < _PASSED_OVER_BYTES:
                message = await receive()
                length += len(message.get("body", b""))
                if message["type"] != "http.request" or not message.get("more_body", False):
                    return
    except TimeoutError:
        return


async def question_of(request: Request, bodies: Bodies) -> bytes:
    """The body of a request whose content type is JSON.

    Raises
    ------
    QuestionError
        As `Bodies.body_of`, or if the content type is another one.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        message = "a request must be sent as application/json"
        raise QuestionError(("", message), status=415, unread=True)
    return await bodies.body_of(request, most_bytes=JSON_BYTES)


MOST_FILES = 256
MOST_BYTES = 128_000_000

_ID = re.compile(r"upload:[0-9a-f]{16}(\.[a-z0-9]+)?")
_ENDINGS = {
    "table": (".csv", ".tsv", ".txt", ".json", ".sp", ".spdx", ".xml", ".xlsx"),
    "cube": (".npz", ".npy", ".tif", ".tiff", ".h5", ".hdf5", ".nc"),
    "either": (".mat",),
    "matrix": (".clf", ".dng", ".dcp"),
    "toml": (".toml",),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Upload:
    """A file that was dropped.

    Attributes
    ----------
    id
        By which questions name it: ``upload:``, a digest of its content, and its ending.
    label
        What it was called, as far as it can be shown; never a path.
    path
        Where it lies, under a name of ours.
    kind
        ``table``, ``cube``, ``either``, ``matrix`` or ``toml``, by its ending.
    """

    id: str
    label: str
    path: Path
    kind: str
    size_bytes: int


class Kept:
    """The files that a question may name."""

    def __init__(self) -> None:
        self._kept: OrderedDict[str, Upload] = OrderedDict()
        self._lock = threading.Lock()

    def hold(self, files: tuple[Upload, ...]) -> None:
        """Keep these files, and no others."""
        with self._lock:
            self._kept = OrderedDict((one.id, one) for one in files)

    def held(self) -> tuple[Upload, ...]:
        """All files."""
        with self._lock:
            return tuple(self._kept.values())

    def named(self, word: str) -> Upload | None:
        """The file that a word of a study names; ``None`` if it names none of ours.

        Raises
        ------
        QuestionError
            If it names one that is not here any more.
        """
        match = _ID.match(word)
        if match is None:
            return None
        with self._lock:
            found = self._kept.get(match[0])
        if found is None:
            raise QuestionError(
                (
                    "",
                    "this was a file that somebody dropped, and this server does not have it (any "
                    "more); drop the file again and use it here",
                )
            )
        return found


class Uploads(Kept):
    """A temporary folder; when it is full the oldest files go."""

    def __init__(self) -> None:
        super().__init__()
        self._folder = Path(tempfile.mkdtemp(prefix="chromanoise-"))

    def keep(self, name: str, content: bytes) -> Upload:
        """The file, written.

        Raises
        ------
        QuestionError
            If its ending says that nothing here reads it, or it is empty.
        """
        label, ending = label_of(name), _ending(name)
        kind = next((kind for kind, known in _ENDINGS.items() if ending in known), None)
        if kind is None:
            every = ", ".join(one for known in _ENDINGS.values() for one in known)
            raise QuestionError(("file", f"{label}: the page reads files that end in {every}"))
        if not content:
            raise QuestionError(("file", f"{label}: the file is empty"))
        digest = hashlib.sha256(ending.encode() + content).hexdigest()[:16]
        path = self._folder / f"{digest}{ending}"
        one = Upload(
            id=f"upload:{digest}{ending}",
            label=label,
            path=path,
            kind=kind,
            size_bytes=len(content),
        )
        with self._lock:
            self._kept.pop(one.id, None)
            self._make_room(one.size_bytes)
            path.write_bytes(content)
            self._kept[one.id] = one
        return one

    @contextmanager
    def empty_folder(self) -> Iterator[Path]:
        """A folder for one job, removed with all that is in it, however the job ends."""
        made = tempfile.TemporaryDirectory(dir=self._folder, ignore_cleanup_errors=True)
        with made as name:
            yield Path(name)

    def close(self) -> None:
        """Remove all of it."""
        shutil.rmtree(self._folder, ignore_errors=True)

    def _make_room(self, size_bytes: int) -> None:
        def total() -> int:
            return sum(one.size_bytes for one in self._kept.values())

        while self._kept and (len(self._kept) >= MOST_FILES or total() + size_bytes > MOST_BYTES):
            _, oldest = self._kept.popitem(last=False)
            oldest.path.unlink(missing_ok=True)


def upload_at(path: Path) -> Upload:
    """A file of the server's user, to be read as an uploaded table; it is not kept."""
    size_bytes = path.stat().st_size if path.exists() else 0
    label = label_of(path.name)
    return Upload(id="", label=label, path=path.absolute(), kind="table", size_bytes=size_bytes)


def label_of(name: str) -> str:
    r"""The last step of a name, as far as it can be shown.

    Examples
    --------
    >>> label_of("../../etc/pass\x00wd.csv"), label_of("C:\\curves\\night.csv")
    ('passwd.csv', 'night.csv')
    """
    last = re.split(r"[/\\]", name)[-1]
    return "".join(c for c in last if c.isprintable()).strip()[:60] or "a file"


def in_path(word: str, upload: Upload) -> str:
    """A word of a study with the file's path in place of its id: a light may have more behind."""
    return word.replace(upload.id, str(upload.path), 1)


def in_words(text: str, upload: Upload) -> str:
    """A sentence or a name that speaks of the file as its person calls it."""
    stem = Path(upload.label).stem or upload.label
    return text.replace(str(upload.path), upload.label).replace(upload.path.stem, stem)


def _ending(name: str) -> str:
    return Path(label_of(name)).suffix.lower()
