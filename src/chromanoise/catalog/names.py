"""The error for a name that is not in the catalog."""

import re
from collections.abc import Sequence
from difflib import get_close_matches

from chromanoise.errors import InputError


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
    plain = {one: re.sub("<[^>]*>", "", one).lower() for one in known}
    near = get_close_matches(name.lower(), list(plain.values()), n=3, cutoff=0.4)
    meant = [one for one in plain if plain[one] in near]
    remedy = f"did you mean {' or '.join(meant)}?" if meant else "see the catalog"
    return InputError(subject, requirement, value=name, remedy=remedy)
