"""Write the stubs of classes that are made from declared fields, or compare them.

    python tools/make_stubs.py [--check]

``--check`` writes nothing and ends with status 1 where a stub is not the one that would be
written.
"""

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import UnionType
from typing import Any, Literal, Union, get_args, get_origin

import chromanoise
from chromanoise.base.properties import beside_their_needs
from chromanoise.sensor import PIXEL
from chromanoise.study.function_settings import described_settings
from chromanoise.study.keywords import NAMES

PACKAGE = Path(chromanoise.__file__).parent
_PIXEL_HEAD = '''\
"""Written by tools/make_stubs.py from the fields of `Pixel`: change them there."""

from dataclasses import dataclass
from typing import TypedDict
'''
_KEYWORDS_HEAD = '''\
"""Written by tools/make_stubs.py from the classes of a study: change them there."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal, TypedDict

NAMES: Mapping[str, str]
'''


def of_pixel() -> str:
    """The stub of the classes that hold any of a pixel's values."""
    of_class = "".join(f"    {name}: float | None = ...\n" for name in PIXEL)
    of_settings = "".join(f"    {name}: float\n" for name in beside_their_needs(PIXEL))
    return (
        f"{_PIXEL_HEAD}\n@dataclass(frozen=True, kw_only=True)\nclass PartialPixel:\n"
        f"{of_class}\nclass PixelSettings(TypedDict, total=False):\n{of_settings}"
    )


def of_keywords() -> str:
    """The stub of the keywords of each function of Python."""
    written = {
        function: {one.name: _source(one.of.type) for one in described_settings(function)}
        for function in NAMES
    }
    shared = set.intersection(*(set(lines.items()) for lines in written.values()))
    text = _KEYWORDS_HEAD + _class("_Shared(TypedDict", written["analyze"], shared)
    for function, name in NAMES.items():
        own = set(written[function].items()) - shared
        text += _class(f"{name}(_Shared", written[function], own)
    return text


def _class(head: str, lines: Mapping[str, str], of: set[tuple[str, str]]) -> str:
    """A class with those of the lines, in their order."""
    own = [f"    {name}: {kind}\n" for name, kind in lines.items() if (name, kind) in of]
    return f"\nclass {head}, total=False):\n{''.join(own) or '    pass' + chr(10)}"


def _source(kind: Any) -> str:
    """A type as Python."""
    inside, origin = get_args(kind), get_origin(kind)
    if origin is Literal:  # in an order that does not depend on what was imported before
        return f"Literal[{', '.join(sorted(map(repr, inside)))}]".replace("'", '"')
    if origin in (Union, UnionType):
        return " | ".join(map(_source, inside))
    name = {Sequence: "Sequence", Mapping: "Mapping"}.get(origin, getattr(kind, "__name__", ""))
    return f"{name}[{', '.join(map(_source, inside))}]" if inside else name


STUBS = {"sensor/partial_pixel.pyi": of_pixel, "study/keywords.pyi": of_keywords}


def main() -> int:
    """Write the stubs; or compare them, and return 1 if one differs."""
    differ = 0
    for name, written in STUBS.items():
        file = PACKAGE / name
        if "--check" not in sys.argv[1:]:
            file.write_text(written(), encoding="utf-8")
        elif not file.is_file() or file.read_text(encoding="utf-8") != written():
            print(f"{file} is not up to date; run python tools/make_stubs.py")
            differ = 1
    return differ


if __name__ == "__main__":
    sys.exit(main())
