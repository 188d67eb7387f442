"""The error for a name that is not in the catalog."""

import re
from collections.abc import Sequence

from chromanoise.errors import InputError, did_you_mean


def unknown_name(
    subject: str, name: str, known: Sequence[str], *, requirement: str = "must be in the catalog"
) -> InputError:
    """The error for a name that is not in the catalog; its remedy gives the nearest names.

    Parameters
    ----------
    subject
        What the name stands for: ``sensor``, ``illuminant``, ``filter``.
    name
        The name that the user wrote.
    known
        The names in the catalog; families as ``LED<nm>/<width>``.
    requirement
        The requirement in the message.

    Examples
    --------
    >>> str(unknown_name("filter", "ircut-schot", ["ircut-schott", "wratten-12"]))
    "filter must be in the catalog, but is 'ircut-schot'; did you mean ircut-schott?"
    >>> str(unknown_name("filter", "x", ["ircut-schott"]))
    "filter must be in the catalog, but is 'x'; see the catalog"
    """
    remedy = did_you_mean(name, known, "see the catalog", plain=_without_parameters)
    if "<T>K" in known and re.fullmatch(r"\d+(\.\d+)?", name):
        remedy = f"did you mean {name}K, a black body?"
    return InputError(subject, requirement, value=name, remedy=remedy)


def _without_parameters(name: str) -> str:
    """A family such as ``LED<nm>/<width>`` without its parameters, in lower case."""
    return re.sub("<[^>]*>", "", name).lower()
