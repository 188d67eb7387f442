"""Write the stub of classes that are made from the properties of a pixel, or compare it.

    python tools/make_stubs.py [--check]

``--check`` writes nothing and ends with status 1 where the stub is not the one that would be
written.
"""

import sys
from pathlib import Path

import chromanoise
from chromanoise.properties import beside_their_needs
from chromanoise.sensor import PIXEL

STUB = Path(chromanoise.__file__).parent / "sensor" / "partial_pixel.pyi"
_HEAD = '''\
"""Written by tools/make_stubs.py from the fields of `Pixel`: change them there."""

from dataclasses import dataclass
from typing import TypedDict
'''


def stub() -> str:
    """The text of the stub."""
    of_class = "".join(f"    {name}: float | None = ...\n" for name in PIXEL)
    of_settings = "".join(f"    {name}: float\n" for name in beside_their_needs(PIXEL))
    return (
        f"{_HEAD}\n@dataclass(frozen=True, slots=True, kw_only=True)\nclass PartialPixel:\n"
        f"{of_class}\nclass PixelSettings(TypedDict, total=False):\n{of_settings}"
    )


def main() -> int:
    """Write the stub; or compare it, and return 1 if it differs."""
    if "--check" not in sys.argv[1:]:
        STUB.write_text(stub(), encoding="utf-8")
        return 0
    same = STUB.is_file() and STUB.read_text(encoding="utf-8") == stub()
    if not same:
        print(f"{STUB} is not up to date; run python tools/make_stubs.py")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
