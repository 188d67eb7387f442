"""What a browser asks, read with care: JSON of bounded size, kinds of values checked."""

import asyncio
import json
from collections.abc import Mapping
from typing import Any, NoReturn

from starlette.requests import Request

from chromanoise.page.guard import JSON_BYTES

_PATIENCE_S = 30.0
_PASSED_OVER_BYTES = 32_000_000
_LONG = 65_536  # bytes above which a body waits for its turn to be held in memory


class QuestionError(Exception):
    """A question that gets no answer but sentences, each beside the thing that it is about.

    Attributes
    ----------
    faults
        Pairs of where (``sensors.0.name``) and sentence.
    status
        Of HTTP: 200 where a question that is well formed holds a value that cannot be, for it got
        its answer, and browsers log every other status as an error of the page.
    """

    def __init__(self, *faults: tuple[str, str], status: int = 200) -> None:
        super().__init__("; ".join(sentence for _, sentence in faults))
        self.faults, self.status = faults, status


def malformed(where: str, sentence: str) -> QuestionError:
    """The error of a question that no page of ours would ask."""
    return QuestionError((where, sentence), status=400)


async def body_of(request: Request, *, most_bytes: int, turns: asyncio.Semaphore) -> bytes:
    """The body, read in pieces and refused as soon as it is too long.

    Parameters
    ----------
    most_bytes
        Of the body.
    turns
        How many long bodies are held at once; others wait unread.

    Raises
    ------
    QuestionError
        If it is too long, or does not come.
    """
    told = request.headers.get("content-length", "")
    if told.isdecimal() and int(told) > most_bytes:
        await _passed_over(request)
        raise _too_long(most_bytes)
    if told.isdecimal() and int(told) <= _LONG:
        return await _read(request, most_bytes)
    async with turns:
        return await _read(request, most_bytes)


def data_of(body: bytes) -> dict[str, Any]:
    """The JSON object in a body.

    Raises
    ------
    QuestionError
        If it is none, is nested too deep, or holds a number that JSON does not have.
    """
    try:
        told = json.loads(body, parse_constant=_no_number)
    except RecursionError:
        raise malformed("", "the question nests too deep to be one of this page") from None
    except ValueError as error:  # of encoding, of grammar, or of a number of thousands of digits
        raise malformed("", f"the question is no JSON: {str(error)[:200]}") from None
    if not isinstance(told, dict):
        raise malformed("", f"the question must be a JSON object, but is a {_kind(told)}")
    return told


def field(told: Mapping[str, Any], name: str, kind: type, default: Any) -> Any:
    """One value of a question, of the kind that it must have.

    Raises
    ------
    QuestionError
        If it is of another kind.
    """
    value = told.get(name, default)
    if value is not default and (
        not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool)
    ):
        raise malformed(name, f"{name} must be a JSON {_NAMES[kind]}, but is a {_kind(value)}")
    return value


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


def _no_number(word: str) -> NoReturn:
    raise malformed("", f"the question holds {word}, which is no number of JSON")


def _too_long(most_bytes: int) -> QuestionError:
    return QuestionError(
        ("", f"that is more than the {most_bytes / 1e6:g} MB which are taken at once"), status=413
    )


async def _read(request: Request, most_bytes: int) -> bytes:
    pieces, length = [], 0
    try:
        async with asyncio.timeout(_PATIENCE_S):
            async for piece in request.stream():
                length += len(piece)
                if length > most_bytes:
                    break
                pieces.append(piece)
    except TimeoutError:
        told = "the question did not arrive in time; ask again"
        raise QuestionError(("", told), status=408) from None
    if length > most_bytes:
        pieces.clear()
        await _passed_over(request)
        raise _too_long(most_bytes)
    return b"".join(pieces)


async def _passed_over(request: Request) -> None:
    """Let go by what still comes, up to a bound: who is cut off while speaking hears no answer."""
    length = 0
    try:
        async with asyncio.timeout(_PATIENCE_S):
            while length < _PASSED_OVER_BYTES:
                message = await request.receive()
                length += len(message.get("body", b""))
                if message["type"] != "http.request" or not message.get("more_body", False):
                    return
    except TimeoutError:
        return


async def question_of(request: Request, turns: asyncio.Semaphore) -> dict[str, Any]:
    """The JSON question of a request.

    Raises
    ------
    QuestionError
        As `body_of` and `data_of`, or if it does not say that it is JSON.
    """
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind != "application/json":
        await _passed_over(request)
        raise QuestionError(("", "a question is sent as application/json"), status=415)
    return data_of(await body_of(request, most_bytes=JSON_BYTES, turns=turns))
