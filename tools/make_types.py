"""Write the TypeScript types of a chart from the Python classes that describe it.

python tools/make_types.py            writes types/charts.d.ts
python tools/make_types.py --check    ends with status 1 where that file is not up to date
"""

import sys
from dataclasses import is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints

from chromanoise.charts.description import Chart, data_fields

ROOT = Path(__file__).resolve().parents[1]
TYPES = ROOT / "types" / "charts.d.ts"
_PLAIN = {float: "number", int: "number", str: "string", bool: "boolean", NoneType: "null"}
_HEAD = (
    "/** A chart as one description, written from chromanoise.charts.description by\n"
    " * tools/make_types.py. Nothing of this file is shipped. */\n\n"
    'import type { Table } from "answers";\n'
)


def types_of_charts() -> str:
    """The text of the file."""
    found: dict[type, str] = {}
    _add(Chart, found)
    return _HEAD + "".join(found.values())


def _add(noun: type, found: dict[type, str]) -> None:
    """Add the interface of a class and of all classes of its fields."""
    if noun in found:
        return
    found[noun] = ""  # its place is before those of its fields
    hints = get_type_hints(noun)
    own = [f"  {name}: {_type(hints[name], found)};\n" for name in data_fields(noun)]
    if noun is Chart:
        own.append("  table: Table;\n")
    found[noun] = f"\nexport interface {noun.__name__} {{\n{''.join(own)}}}\n"


def _type(hint: Any, found: dict[type, str]) -> str:
    origin, arguments = get_origin(hint), get_args(hint)
    if origin is Literal:
        return " | ".join(f'"{one}"' for one in arguments)
    if origin is UnionType:
        return " | ".join(_type(one, found) for one in arguments)
    if origin is tuple and arguments[-1] is Ellipsis:
        one = _type(arguments[0], found)
        return f"({one})[]" if " | " in one else f"{one}[]"
    if origin is tuple:
        return f"[{', '.join(_type(one, found) for one in arguments)}]"
    if is_dataclass(hint) and isinstance(hint, type):
        _add(hint, found)
        return hint.__name__
    return _PLAIN[hint]


def main() -> None:
    """Write the file, or compare it."""
    text = types_of_charts()
    if "--check" not in sys.argv[1:]:
        TYPES.write_text(text, encoding="utf-8")
    elif text != TYPES.read_text(encoding="utf-8"):
        sys.exit("types/charts.d.ts is not up to date: run python tools/make_types.py")


if __name__ == "__main__":
    main()
