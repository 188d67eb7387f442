"""Routes of the page, and the server that listens on this machine only.

All computation runs in worker processes, so that the page itself loads at once and no question can
crash the server.
"""

import asyncio
import socket
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import Route
from starlette.types import ASGIApp, Receive, Scope, Send

from chromanoise.page.files import asset_reply, index, page_policy
from chromanoise.page.middleware import UPLOAD_BYTES, AsciiJSONResponse, fault_reply, guarded
from chromanoise.page.requests import Bodies, QuestionError, malformed, passed_over, question_of
from chromanoise.page.uploads import Uploads
from chromanoise.page.work import Workers

if TYPE_CHECKING:
    from uvicorn import Server

_LONGEST_SENTENCE = 1000
_MOST_FAULTS = 100  # in one answer


class _Server:
    """What the routes share while the server lives."""

    def __init__(self, study: dict[str, Any] | None) -> None:
        self.uploads = Uploads()
        self.workers = Workers(study)
        self.bodies = Bodies()

    async def done(self, name: str, *given: Any) -> Any:
        """What a job returns; it may name dropped files."""
        return await self.workers.done(name, *given, kept=self.uploads.held())

    def close(self) -> None:
        """End the processes and remove the files."""
        self.workers.close()
        self.uploads.close()


def application(*, port: int, study: dict[str, Any] | None = None) -> ASGIApp:
    """The page as an ASGI application.

    Parameters
    ----------
    port
        On which it is served: part of the only names that it answers to.
    study
        To start from, as plain data; ``None`` for the page's own.
    """

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        app.state.server = server = _Server(study)
        server.workers.begin()
        try:
            yield
        finally:
            server.close()

    app = Starlette(
        lifespan=lifespan,
        routes=[
            Route("/", index),
            Route("/assets/{path:path}", asset_reply),
            Route("/api/choices", _replying(_choices)),
            Route("/api/answer", _replying(_answer), methods=["POST"]),
            Route("/api/picture", _replying(_picture), methods=["POST"]),
            Route("/api/upload", _replying(_upload), methods=["POST"]),
            Route("/api/texts", _replying(_texts), methods=["POST"]),
        ],
        exception_handlers={HTTPException: _told_status, Exception: _told_crash},
    )
    return guarded(app, port=port, policy=page_policy)


def page_server(listening: socket.socket, *, study: dict[str, Any] | None = None) -> "Server":
    """The page's server; ``run(sockets=[listening])`` serves until the process is told to stop.

    Parameters
    ----------
    listening
        Of `listening_socket`.
    study
        To start from.
    """
    import uvicorn

    config = uvicorn.Config(
        application(port=listening.getsockname()[1], study=study),
        log_level="error",
        access_log=False,
        server_header=False,
        ws="none",
        timeout_graceful_shutdown=2,
    )
    return uvicorn.Server(config)


def listening_socket(port: int) -> socket.socket:
    """A socket of this machine only; port 0 takes any that is free.

    Raises
    ------
    OSError
        If the port is taken or may not be used.
    """
    # only of a socket that is told to be TCP does asyncio send what is short at once: a header
    # alone would keep its answer waiting for the browser's delayed acknowledgement, some 40 ms
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        if sys.platform != "win32":  # where it would let two servers share a port
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(("127.0.0.1", port))
        listening.listen(256)
    except OSError:
        listening.close()
        raise
    return listening


def _replying(
    reply: Callable[[Request, _Server], Awaitable[Response]],
) -> Callable[[Request], Awaitable[Response]]:
    """A route whose refusals become sentences, and whose lost askers become nothing."""

    async def replied(request: Request) -> Response:
        try:
            return await reply(request, request.app.state.server)
        except QuestionError as error:
            return _refusing(error)
        except ClientDisconnect:
            return Response(status_code=400)

    return replied


def _refusing(error: QuestionError) -> Response:
    faults = [
        {"where": where[:_LONGEST_SENTENCE], "sentence": told[:_LONGEST_SENTENCE]}
        for where, told in error.faults[:_MOST_FAULTS]
    ]
    # what follows of a body that was not read to its end is not read either
    headers = {} if error.status in (200, 400, 503) else {"Connection": "close"}
    kind = _ToldFirst if error.unread else AsciiJSONResponse
    return kind({"faults": faults}, status_code=error.status, headers=headers)


class _ToldFirst(AsciiJSONResponse):
    """An answer that is whole before the body of its question has come, and passes over that."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        head = {"status": self.status_code, "headers": self.raw_headers}
        await send({"type": "http.response.start", **head})
        await send({"type": "http.response.body", "body": self.body, "more_body": True})
        await passed_over(receive)
        await send({"type": "http.response.body", "body": b""})


async def _choices(request: Request, server: _Server) -> Response:
    return _json(await server.done("choices"))


async def _answer(request: Request, server: _Server) -> Response:
    return _json(await server.done("answer", await question_of(request, server.bodies)))


async def _texts(request: Request, server: _Server) -> Response:
    return _json(await server.done("texts", await question_of(request, server.bodies)))


async def _picture(request: Request, server: _Server) -> Response:
    png, summary = await server.done("picture", await question_of(request, server.bodies))
    return Response(png, media_type="image/png", headers={"X-Chromanoise-Summary": summary})


async def _upload(request: Request, server: _Server) -> Response:
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/octet-stream":
        told = "a file is sent as application/octet-stream"
        raise QuestionError(("file", told), status=415, unread=True)
    name = unquote(request.headers.get("x-filename", ""))
    if not name:
        raise malformed("file", "a file is sent with its name in the header X-Filename")
    content = await server.bodies.body_of(request, most_bytes=UPLOAD_BYTES)
    upload = await asyncio.to_thread(server.uploads.keep, name, content)
    del content
    return _json(await server.done("previewed", upload))


def _json(text: str) -> Response:
    return Response(text, media_type="application/json")


async def _told_status(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    sentences = {404: "there is nothing of that name here", 405: "that is not asked like this"}
    return fault_reply(error.status_code, sentences.get(error.status_code, error.detail))


async def _told_crash(request: Request, error: Exception) -> Response:
    return fault_reply(500, "that could not be computed; the server tells more where it runs")
