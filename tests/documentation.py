"""What the docstring of a public name must hold, and what one lacks."""

import inspect
import re

from chromanoise.base import Record

SECTIONS = r"^(Parameters|Attributes|Other Parameters|Returns|Raises|Notes|Examples)\n-{3,}\n"
QUANTITY = re.compile(r"(^|_)(lux|ms|s|nm|um|e|db|lx|s_per_e)$|^(qe|irradiance)$")
UNIT = re.compile(r"\[[^\]]+\]|^ *As ")  # or where the unit is documented
NO_QUANTITY = {"source", "e"}
ANY = ("args", "kwargs")  # of a protocol
SOURCE = re.compile(r"\beq\. \d|\(\d{4}\)|Table \d")


def sections(text):
    """The summary under '', and the text of each section."""
    parts = re.split(SECTIONS, inspect.cleandoc(text), flags=re.MULTILINE)
    return {"": parts[0], **dict(zip(parts[1::2], parts[2::2], strict=True))}


def entries(text):
    """The text of each name in a section of parameters."""
    found = {}
    for head, body in re.findall(r"^(\S.*)\n((?:(?:    .*)?\n?)*)", text, flags=re.MULTILINE):
        for name in head.partition(" : ")[0].split(","):
            found[name.strip().lstrip("*")] = body
    return found


def faults_of_function(name, function, *, computes, text=None):
    """What the documentation of a function lacks."""
    text = function.__doc__ if text is None else text
    if not text:
        return [f"{name}: no docstring"]
    message, faults = sections(text), []
    signature = inspect.signature(function)
    wanted = [one for one in signature.parameters if one not in ("self", "cls")]
    documented = entries(message.get("Parameters", "")) | entries(
        message.get("Other Parameters", "")
    )
    faults += [
        f"{name}: {one} is no documented parameter" for one in wanted if one not in documented
    ]
    faults += faults_of_units(name, {one: documented.get(one, "") for one in wanted})
    returns = signature.return_annotation not in (None, "None", inspect.Signature.empty)
    if wanted and returns and "Returns" not in message:
        faults.append(f"{name}: no Returns")
    if (
        re.search(r"^ +raise ", inspect.getsource(function), re.MULTILINE)
        and "Raises" not in message
    ):
        faults.append(f"{name}: no Raises")
    if computes and not SOURCE.search(text):
        faults.append(f"{name}: no source")
    return faults


def faults_of_units(name, documented):
    return [
        f"{name}: no unit of {one}"
        for one, text in documented.items()
        if QUANTITY.search(one) and one not in NO_QUANTITY and not UNIT.search(text)
    ]


def faults_of_class(name, kind):
    """What the documentation of a class and of its own methods lacks."""
    if not kind.__doc__:
        return [f"{name}: no docstring"]
    values, faults = sections(kind.__doc__), []
    if issubclass(kind, Record):
        described = {one: field.description for one, field in kind.model_fields.items()}
        faults += [f"{name}: {one} is not described" for one, text in described.items() if not text]
    else:
        documented = {}
        for one in reversed(kind.__mro__[:-1]):  # fields of its bases are documented there
            text = sections(one.__doc__ or "")
            documented |= entries(text.get("Attributes", "")) | entries(text.get("Parameters", ""))
        fields = [
            one
            for one in inspect.signature(kind).parameters
            if not one.startswith("_") and one not in ANY
        ]
        faults += [f"{name}: {one} is not documented" for one in fields if one not in documented]
        grouped = {one: documented.get(one, "") for one in fields}
        faults += faults_of_units(name, grouped)
    checks = vars(kind).get("__post_init__")
    if checks is not None and "Raises" not in values:
        faults.append(f"{name}: no Raises")
    for own, method in vars(kind).items():
        if own.startswith("_") or own in ("plot", "model_config"):
            continue
        function = getattr(method, "fget", None) or getattr(method, "__func__", method)
        if inspect.isfunction(function):
            computes = own.endswith("_db")
            faults += faults_of_function(f"{name}.{own}", function, computes=computes)
    return faults
