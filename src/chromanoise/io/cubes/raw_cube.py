"""What a file of pixels says, before it is a cube."""

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
    """What a file holds; wavelengths and scale are read only where the caller does not say."""

    pixels: Shaped[Array, "h w m"] | RowSource
    wavelengths: Callable[[], tuple[Array, Notes]] | None = None
    scale: Callable[[], float | None] = lambda: None
    description: str = ""
    units: str = ""
    notes: Notes = ()


def unused_key(key: str | None) -> Notes:
    """A note where ``key`` has nothing to choose from."""
    return () if key is None else (f"key {key!r} not used: the file holds one array",)


def by(shape: tuple[int, ...]) -> str:
    """A shape as people write it: 156x9025."""
    return "x".join(str(n) for n in shape) or "scalar"


def refuse_other_shape(
    path: Path, pixels: Shaped[Array, "h w m"] | RowSource, shape: tuple[int, int] | None
) -> None:
    """Refuse a ``shape`` that contradicts the picture in the file."""
    if shape is not None and tuple(shape) != pixels.shape[:2]:
        raise InputError(
            "shape",
            f"must be that of {path}, {by(pixels.shape[:2])} pixels",
            value=tuple(shape),
            found=f"is {by(shape)}",
            remedy="omit it",
        )
