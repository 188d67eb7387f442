"""The content of a file of pixels before it becomes a cube."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from chromanoise._check import Array
from chromanoise._shapes import Shaped
from chromanoise.errors import InputError
from chromanoise.scene.rows import RowSource

Notes = tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """The content of a file; wavelengths and scale are read only if the caller gives none."""

    pixels: Shaped[Array, "h w m"] | RowSource
    wavelengths: Callable[[], tuple[Array, Notes]] | None = None
    scale: Callable[[], float | None] = lambda: None
    description: str = ""
    units: str = ""
    notes: Notes = ()


def by(shape: tuple[int, ...]) -> str:
    """A shape as text: 156x9025."""
    return "x".join(str(n) for n in shape) or "scalar"


def refuse_other_shape(
    path: Path, pixels: Shaped[Array, "h w m"] | RowSource, shape: tuple[int, int] | None
) -> None:
    """Raise an error if ``shape`` contradicts the picture in the file."""
    if shape is not None and tuple(shape) != pixels.shape[:2]:
        raise InputError(
            "shape",
            f"must be that of {path}, {by(pixels.shape[:2])} pixels",
            value=tuple(shape),
            found=f"is {by(shape)}",
            remedy="omit it",
        )
