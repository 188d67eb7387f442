"""What a file of pixels says, before it is a cube; and how foreign readers' faults are told."""

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from jaxtyping import Shaped

from chromanoise import _check
from chromanoise._check import Array

Notes = tuple[str, ...]

IN_PLACE = "store it as ENVI or .npy, which are read in place"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """What a file holds; wavelengths and scale are read only where the caller does not say."""

    pixels: Shaped[Array, "h w m"]
    wavelengths: Callable[[], tuple[Array, Notes]] | None = None
    scale: Callable[[], float | None] = lambda: None
    description: str = ""
    units: str = ""
    notes: Notes = ()


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """Turns whatever a foreign reader throws at a bad file into one sentence."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    except _check.InputError:
        raise
    except MemoryError:
        raise _check.InputError(
            f"{path}: too large for this machine's memory; {IN_PLACE}"
        ) from None
    except Exception as error:  # parsers throw anything
        raise _check.InputError(
            f"{path}: not a readable {kind} file ({reason(error)}); it is damaged or cut short, "
            "save it again"
        ) from None


def reason(error: Exception) -> str:
    """What an error says, on one line."""
    text = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(str(text).split())[:120]


def unused_key(key: str | None) -> Notes:
    """A note where --key has nothing to choose from."""
    return () if key is None else (f"--key {key} not used: the file holds one array",)


def by(shape: tuple[int, ...]) -> str:
    """A shape as people write it: 156x9025."""
    return "x".join(str(n) for n in shape) or "scalar"


def refuse_other_shape(
    path: Path, pixels: Shaped[Array, "h w m"], shape: tuple[int, int] | None
) -> None:
    """Refuse a --shape that contradicts the picture in the file."""
    if shape is not None and tuple(shape) != pixels.shape[:2]:
        raise _check.InputError(
            f"{path}: the file holds {by(pixels.shape[:2])} pixels, but --shape says "
            f"{by(shape)}; leave --shape away"
        )
