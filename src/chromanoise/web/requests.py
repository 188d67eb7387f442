"""Requests to the page over HTTP: access checks, bodies of bounded size, and the page's files.

Only this page in a browser on this machine is accepted. The drawing modules of the figures are
served as the folder ``draw``.
"""

import asyncio
import base64
import hashlib
import re
from collections.abc import Callable
from importlib.resources import files
from importlib.resources.abc import Traversable

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from chromanoise.base import dataclass, palette_css
from chromanoise.web.page_questions import QuestionError, faults_json

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


def fault_reply(status: int, sentence: str, *, where: str = "") -> Response:
    """One fault as every answer of the server tells it."""
    text = faults_json([(where, sentence)])
    return Response(text, status_code=status, media_type="application/json")


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


@dataclass(eq=False)
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
