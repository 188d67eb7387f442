"""Routes of the page, and the server that listens on this machine only.

All computation runs in worker processes, so that the page itself loads at once and no question can
crash the server.
"""

import asyncio
import socket
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from starlette.applications import Starlette
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect, Request
from starlette.responses import Response
from starlette.routing import Route
from starlette.types import ASGIApp, Receive, Scope, Send

from chromanoise.web.page_questions import QuestionError, faults_json, malformed
from chromanoise.web.processes import Workers
from chromanoise.web.requests import (
    UPLOAD_BYTES,
    Bodies,
    asset_reply,
    fault_reply,
    guarded,
    index,
    page_policy,
    passed_over,
    question_of,
)
from chromanoise.web.uploads import Uploads, upload_at

if TYPE_CHECKING:
    from uvicorn import Server


class _Server:
    """The state that the routes share."""

    def __init__(self, study: dict[str, Any] | None, front: Path | None) -> None:
        self.uploads = Uploads()
        self.front = front
        self.workers = Workers(study)
        self.bodies = Bodies()

    async def done(self, request: Request, name: str, *given: Any) -> Any:
        """Run a job in a worker process and return its result; it may use uploaded files.

        Raises
        ------
        ClientDisconnect
            If the client has disconnected; the job is then stopped.
        """
        work = asyncio.ensure_future(self.workers.done(name, *given, kept=self.uploads.held()))
        gone = asyncio.ensure_future(_disconnected(request))
        try:
            await asyncio.wait({work, gone}, return_when=asyncio.FIRST_COMPLETED)
            if not work.done():
                raise ClientDisconnect
            return work.result()
        finally:
            gone.cancel()
            work.cancel()

    def close(self) -> None:
        """End the processes and remove the files."""
        self.workers.close()
        self.uploads.close()


def application(
    *, port: int, study: dict[str, Any] | None = None, front: Path | None = None
) -> ASGIApp:
    """The page as an ASGI application.

    Parameters
    ----------
    port
        Port of the server; requests must name it in ``Host``.
    study
        The initial study as plain data; ``None`` for the default.
    front
        A file ``front.json`` that the page shows; it is read again whenever the page is loaded.
    """

    @asynccontextmanager
    async def lifespan(app: Starlette) -> AsyncIterator[None]:
        app.state.server = server = _Server(study, front)
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
            Route("/api/explanations", _replying(_told("explanations"))),
            Route("/api/front", _replying(_front)),
            Route("/api/story", _replying(_told("story"))),
            Route("/api/answer", _replying(_told("answer")), methods=["POST"]),
            Route("/api/picture", _replying(_picture), methods=["POST"]),
            Route("/api/upload", _replying(_upload), methods=["POST"]),
            Route("/api/texts", _replying(_told("texts")), methods=["POST"]),
            Route("/api/csv", _replying(_csv), methods=["POST"]),
            Route("/api/report", _replying(_report), methods=["POST"]),
            Route("/api/card", _replying(_card), methods=["POST"]),
        ],
        exception_handlers={HTTPException: _status_reply, Exception: _crash_reply},
    )
    return guarded(app, port=port, policy=page_policy)


def page_server(
    listening: socket.socket, *, study: dict[str, Any] | None = None, front: Path | None = None
) -> "Server":
    """The server of the page; ``run(sockets=[listening])`` serves until the process is stopped.

    Parameters
    ----------
    study, front
        As for `application`.
    """
    import uvicorn

    config = uvicorn.Config(
        application(port=listening.getsockname()[1], study=study, front=front),
        log_level="error",
        access_log=False,
        server_header=False,
        ws="none",
        timeout_graceful_shutdown=2,
    )
    return uvicorn.Server(config)


def listening_socket(port: int) -> socket.socket:
    """A socket that accepts connections from this machine only; port 0 selects a free port.

    Raises
    ------
    OSError
        If the port is taken or may not be used.
    """
    # asyncio sets TCP_NODELAY only if the protocol is given; without it, a short reply waits for
    # the delayed acknowledgement of the browser, about 40 ms
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


async def _disconnected(request: Request) -> None:
    """Wait until the client has gone; the body of the request must have been read."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _replying(
    reply: Callable[[Request, _Server], Awaitable[Response]],
) -> Callable[[Request], Awaitable[Response]]:
    """A route that replies to errors with messages and ignores disconnected clients."""

    async def replied(request: Request) -> Response:
        try:
            return await reply(request, request.app.state.server)
        except QuestionError as error:
            return _refusing(error)
        except ClientDisconnect:
            return Response(status_code=400)
        except asyncio.CancelledError:  # of what is being computed when the server ends
            return _refusing(
                QuestionError(("", "the server is stopping; send the request again"), status=503)
            )

    return replied


def _refusing(error: QuestionError) -> Response:
    # what follows of a body that was not read to its end is not read either
    headers = {} if error.status in (200, 400, 503) else {"Connection": "close"}
    kind = _ToldFirst if error.unread else Response
    text = faults_json(error.faults)
    return kind(text, error.status, headers=headers, media_type="application/json")


class _ToldFirst(Response):
    """An answer that is whole before the body of its question has come, and passes over that."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        head = {"status": self.status_code, "headers": self.raw_headers}
        await send({"type": "http.response.start", **head})
        await send({"type": "http.response.body", "body": self.body, "more_body": True})
        await passed_over(receive)
        await send({"type": "http.response.body", "body": b""})


def _told(name: str) -> Callable[[Request, _Server], Awaitable[Response]]:
    """The route that replies with the JSON of a job, which gets the body of a POST."""

    async def told(request: Request, server: _Server) -> Response:
        is_post = request.method == "POST"
        given = [await question_of(request, server.bodies)] if is_post else []
        return _json(await server.done(request, name, *given))

    return told


async def _choices(request: Request, server: _Server) -> Response:
    return _json(await server.done(request, "choices", server.front is not None))


async def _front(request: Request, server: _Server) -> Response:
    if server.front is None:
        raise HTTPException(404)
    return _json(await server.done(request, "previewed", upload_at(server.front)))


async def _csv(request: Request, server: _Server) -> Response:
    text = await server.done(request, "csv", await question_of(request, server.bodies))
    return Response(text, media_type="text/csv")


# to be kept as a file: not shown under the address of the page
_ATTACHED = {"Content-Disposition": "attachment"}


async def _report(request: Request, server: _Server) -> Response:
    return await _in_folder(request, server, "report", "text/html")


async def _card(request: Request, server: _Server) -> Response:
    return await _in_folder(request, server, "card", "application/pdf")


async def _in_folder(request: Request, server: _Server, name: str, kind: str) -> Response:
    """The file that a job makes of a study in a folder for the files of the study."""
    question = await question_of(request, server.bodies)
    with server.uploads.empty_folder() as folder:
        content, hashed = await server.done(request, name, question, folder)
    headers = _ATTACHED | {"X-Chromanoise-Hash": hashed}
    return Response(content, media_type=kind, headers=headers)


async def _picture(request: Request, server: _Server) -> Response:
    png, summary = await server.done(request, "picture", await question_of(request, server.bodies))
    return Response(png, media_type="image/png", headers={"X-Chromanoise-Summary": summary})


async def _upload(request: Request, server: _Server) -> Response:
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/octet-stream":
        sentence = "a file must be sent as application/octet-stream"
        raise QuestionError(("file", sentence), status=415, unread=True)
    name = unquote(request.headers.get("x-filename", ""))
    if not name:
        raise malformed("file", "a file must be sent with its name in the header X-Filename")
    content = await server.bodies.body_of(request, most_bytes=UPLOAD_BYTES)
    upload = await asyncio.to_thread(server.uploads.keep, name, content)
    del content
    return _json(await server.done(request, "previewed", upload))


def _json(text: str) -> Response:
    return Response(text, media_type="application/json")


async def _status_reply(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    sentences = {404: "not found", 405: "method not allowed"}
    return fault_reply(error.status_code, sentences.get(error.status_code, error.detail))


async def _crash_reply(request: Request, error: Exception) -> Response:
    return fault_reply(500, "internal error; see the terminal that runs chromanoise serve")
