"""Packages that are optional: what needs one says so in the same sentence everywhere."""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from chromanoise.base.errors import InputError, Remedy

_INSTALL = "install it with pip install"
if sys.platform == "wasi":  # the page as one file, into which nothing can be installed
    _INSTALL = "use the installed program: pip install"


def optional_package(
    name: str,
    needed_by: str,
    *,
    extra: str,
    where: str = "",
    value: Any = None,
    otherwise: Sequence[Remedy] = (),
) -> Any:
    """Import an optional package or a module of it.

    Parameters
    ----------
    name
        Of the package, or of the module with dots.
    needed_by, where
        The file, the parameter or the output that needs it, and the place in a file.
    extra
        The extra of chromanoise that installs it.
    otherwise
        What can be done without the package.

    Raises
    ------
    InputError
        If the package is not installed.

    Examples
    --------
    >>> optional_package("no_such_package", "a data frame", extra="pandas")
    Traceback (most recent call last):
    chromanoise.base.errors.InputError: a data frame: needs the package no_such_package, which is \
not installed; install it with pip install 'chromanoise[pandas]'
    """
    try:
        return import_module(name)
    except ImportError as error:
        if (error.name or "").partition(".")[0] != name.partition(".")[0]:
            raise  # it is installed, but what it needs is not
        raise _absent(name, needed_by, extra, where, value, otherwise) from None


def refuse_absent_package(
    name: str,
    needed_by: str,
    *,
    extra: str,
    value: Any = None,
    otherwise: Sequence[Remedy] = (),
) -> None:
    """Like `optional_package`, for a package that is imported later or by another process."""
    if is_absent(name):
        raise _absent(name, needed_by, extra, "", value, otherwise)


def is_absent(name: str) -> bool:
    """Whether a package, or that of a module with dots, is not installed."""
    return find_spec(name.partition(".")[0]) is None


def _absent(
    name: str, needed_by: str, extra: str, where: str, value: Any, otherwise: Sequence[Remedy]
) -> InputError:
    return InputError(
        needed_by,
        f"needs the package {name.partition('.')[0]}, which is not installed",
        value=value,
        found=None,
        where=where,
        remedy=(f"{_INSTALL} 'chromanoise[{extra}]'", *otherwise),
    )
