"""Powers and indices in running text: F^T and sigma_i as superscript and subscript."""

import re
from collections.abc import Iterator

LETTERS = r"[A-Za-zΑ-Ωα-ωµ]|SNR|VIF|sigma|theta|phi|mu"
MARKS = re.compile(
    rf"""(?<=[\w)|\]*⁺²])\^(?P<sup>\([^()]*\)|[-+−]?\w+)  # a power
    |(?<=\w)\^(?!\w)                                    # the hat of an estimate
    |(?:(?<!\w)(?P<base>{LETTERS})|(?P<after>\)))_(?P<sub>[A-Za-z0-9]{{1,6}})(?![A-Za-z0-9_]|\.[A-Za-z])""",
    re.VERBOSE,
)
HAT = "\N{COMBINING CIRCUMFLEX ACCENT}"


def pieces(text: str) -> Iterator[tuple[str, str]]:
    """The text in pieces: each with "sup" or "sub", or "" for what stands on the line."""
    at, line = 0, ""
    for mark in MARKS.finditer(text):
        line += text[at : mark.start()] + (mark["base"] or mark["after"] or "")
        at = mark.end()
        kind = "sup" if mark["sup"] else "sub" if mark["sub"] else ""
        if not kind:
            line += HAT
            continue
        raised = (mark["sup"] or mark["sub"]).removeprefix("(").removesuffix(")")
        yield "", line
        yield kind, raised.replace("-", "−")
        line = ""
    yield "", line + text[at:]
