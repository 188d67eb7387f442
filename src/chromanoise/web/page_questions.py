"""What a question to the page consists of: its JSON, its values, and why it is refused."""

import json
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Any

from chromanoise.base import InputError, Setting, json_of


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


_LONGEST_SENTENCE = 1000
_MOST_FAULTS = 100  # in one answer


def faults_json(faults: Iterable[tuple[str, str]]) -> str:
    """The JSON of faults in each reply, in ASCII, because UTF-8 has no unpaired surrogates.

    Parameters
    ----------
    faults
        Pairs of place and sentence; those after the first 100 are left out.
    """
    told = [
        {"where": where[:_LONGEST_SENTENCE], "sentence": sentence[:_LONGEST_SENTENCE]}
        for where, sentence in islice(faults, _MOST_FAULTS)
    ]
    return json.dumps({"faults": told}, allow_nan=False)


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
