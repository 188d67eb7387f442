"""Parse requests: JSON of bounded size, with checks of the types of values."""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from starlette.requests import Request
from starlette.types import Receive

from chromanoise._inputs import json_of
from chromanoise.errors import InputError, Setting
from chromanoise.page.middleware import JSON_BYTES

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
