"""What the docstring of a public name must hold, and what one lacks."""

import builtins
import importlib
import inspect
import re

from chromanoise.base import Record

SECTIONS = r"^(Parameters|Attributes|Other Parameters|Returns|Raises|Notes|Examples)\n-{3,}\n"
QUANTITY = re.compile(r"(^|_)(lux|ms|s|nm|um|e|db|lx|s_per_e)$|^(qe|irradiance)$")
UNIT = re.compile(r"\[[^\]]+\]|^ *As |^ *In ``unit``")  # or where the unit is documented
NO_QUANTITY = {"source", "e"}
ANY = ("args", "kwargs")  # of a protocol
SOURCE = re.compile(r"\beq\. \d|\(\d{4}\)|Table \d")
NUMBERS = re.compile(
    r"\b(float|complex|Float\w*|Int\d*|Integer|Inexact|Complex|Num|ndarray|Array)\b"
)
LEAST_WORDS = 4
CROSS_REFERENCE = re.compile(r"(?<![`\w:])`([A-Za-z_][\w.]*)`(?!`)")


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
    quantities = [one for one in wanted if is_quantity(signature.parameters[one].annotation)]
    faults += [
        f"{name}: {one} is no documented parameter" for one in quantities if one not in documented
    ]
    faults += faults_of_units(name, {one: documented.get(one, "") for one in wanted})
    returns = signature.return_annotation not in (None, "None", inspect.Signature.empty)
    if documented and returns and "Returns" not in message:
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


def is_quantity(annotation):
    """Whether a number or an array is asked for, whose unit or shape no name can say."""
    if annotation is inspect.Parameter.empty:
        return True
    shown = annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)
    named = "str" in shown or "Callable" in shown
    return NUMBERS.search(shown) is not None and not named


def short_entries(name, value):
    """Entries of a function, or of a class and its methods, that only repeat the name.

    A unit or a reference says something in few words.
    """
    text = sections(value.__doc__ or "")
    kinds = ("Parameters", "Other Parameters", "Attributes")
    documented = {} if value.__doc__ is None else entries("".join(text.get(k, "") for k in kinds))
    found = [
        f"{name}: the entry {one} says too little"
        for one, text in documented.items()
        if len(text.split()) < LEAST_WORDS and not UNIT.search(text)
    ]
    for own, member in public_methods(value) if inspect.isclass(value) else ():
        found += short_entries(f"{name}.{own}", member)
    return found


def public_methods(kind):
    """The functions of the own methods and properties of a class by name."""
    for own, method in tuple(vars(kind).items()):
        function = getattr(method, "fget", None) or getattr(method, "__func__", method)
        if inspect.isfunction(function) and not own.startswith("_"):
            yield own, function


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
        of = inspect.signature(kind).parameters
        faults += [
            f"{name}: {one} is not documented"
            for one in fields
            if one not in documented and is_quantity(of[one].annotation)
        ]
        grouped = {one: documented.get(one, "") for one in fields}
        faults += faults_of_units(name, grouped)
    checks = vars(kind).get("__post_init__")
    if checks is not None and "Raises" not in values:
        faults.append(f"{name}: no Raises")
    for own, function in public_methods(kind):
        if own != "plot":
            computes = own.endswith("_db") and not isinstance(vars(kind)[own], property)
            faults += faults_of_function(f"{name}.{own}", function, computes=computes)
    return faults


# ---- cross references ----


def references(text):
    """The names in single backticks."""
    return CROSS_REFERENCE.findall(text or "")


def has(value, steps):
    """Whether a dotted name leads to something public of a value."""
    for step in steps:
        fields = {
            **getattr(value, "__dataclass_fields__", {}),
            **getattr(value, "__annotations__", {}),
        }
        if step in fields or step in getattr(value, "model_fields", ()):
            return True
        own = inspect.ismodule(value) and value.__name__.startswith("chromanoise")
        if own and step not in (*value.__all__, "__version__"):
            return False
        if not hasattr(value, step):
            return False
        value = getattr(value, step)
    return True


def leads_somewhere(name, owner, module, public):
    """Whether a name in the docstring of ``owner`` is public, a parameter, or of another library.

    ``public`` are the values of the public names of all packages by their name.
    """
    first, *rest = name.split(".")
    if inspect.isroutine(owner) or inspect.isclass(owner):
        parameters = getattr(inspect.unwrap(owner), "__signature__", None) or (
            inspect.signature(owner) if not inspect.isclass(owner) else None
        )
        if parameters is not None and first in parameters.parameters:
            return True
        if inspect.isclass(owner) and has(owner, [first, *rest]):
            return True
    if has(module, [first, *rest]) or any(has(one, rest) for one in public.get(first, ())):
        return True
    if hasattr(builtins, name):
        return True
    for end in range(len(rest) + 1, 0, -1):
        path = ".".join([first, *rest][:end])
        try:
            found = importlib.import_module(path)
        except ImportError:
            continue
        if first != "chromanoise" or found in public.get(path.rpartition(".")[2], ()):
            return has(found, rest[end - 1 :])
    return False
