"""How the faults of foreign readers are told."""

import importlib
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from chromanoise import _check

IN_PLACE = "store it as ENVI or .npy, which are read in place"


def library(name: str, what: str) -> Any:
    """A package that only some cubes need.

    Raises
    ------
    InputError
        If it is not installed; how to install it is told.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        raise _check.InputError(
            f"{what}: needs the package {name}, which is not installed; "
            "pip install 'chromanoise[cubes]'"
        ) from None


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """Turns whatever a foreign reader throws at a bad file into one sentence."""
    with warnings.catch_warnings(), reading_rows(path, kind):
        warnings.simplefilter("ignore")
        yield


@contextmanager
def reading_rows(path: Path, kind: str) -> Iterator[None]:
    """The same where several threads read at once: warnings, which they share, stay as they are."""
    try:
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
