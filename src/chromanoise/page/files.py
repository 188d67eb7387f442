"""The files of the page, and the drawing modules of the figures as its folder ``draw``."""

import hashlib
import re
from importlib.resources import files
from importlib.resources.abc import Traversable

from starlette.requests import Request
from starlette.responses import Response

from chromanoise._palette import palette_css
from chromanoise.page.middleware import content_policy, fault_reply

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
_OWN, _DRAW = "page/assets", "figures/draw"  # the second is shared with the report
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
