"""``chromanoise --version``: the version, and which packages are installed for it."""

import platform
import re
from collections.abc import Iterator
from importlib import metadata

from chromanoise import __version__

_NEEDS = re.compile(r"([A-Za-z0-9._-]+)[^;]*(?:;.*extra\s*==\s*['\"]([^'\"]+)['\"])?")
_FOR_DEVELOPERS = ("bench", "dev", "docs")


def installation() -> str:
    """Version, Python, system, and each package that chromanoise uses, by extra.

    ``missing`` packages belong to extras: ``pip install "chromanoise[NAME]"`` installs them.
    """
    lines = [
        f"chromanoise {__version__}",
        f"Python {platform.python_version()} on {platform.system()} {platform.machine()}",
    ]
    groups: dict[str, list[str]] = {}
    for package, extra in _needs():
        groups.setdefault(extra, []).append(f"{package} {_version(package)}")
    width = max(map(len, groups), default=0)
    lines += [f"{name:<{width}}  {', '.join(found)}" for name, found in groups.items()]
    return "\n".join(lines)


def _needs() -> Iterator[tuple[str, str]]:
    """Each package with its extra; none if only the source is here, not an installation."""
    try:
        needs = metadata.requires("chromanoise") or []
    except metadata.PackageNotFoundError:
        return
    for need in needs:
        match = _NEEDS.match(need)
        if match and match[2] not in _FOR_DEVELOPERS and match[1] != "chromanoise":
            yield match[1], match[2] or "required"


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return "missing"
