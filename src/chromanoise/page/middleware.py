"""Checks of requests: only this page in a browser on this machine is accepted."""

import base64
import hashlib
import json
import re
from collections.abc import Callable
from typing import Any

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import JSONResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

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
    hosts
        Of `own_hosts`.
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
    app
        Of starlette.
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
