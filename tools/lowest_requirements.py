"""The declared lower bounds of the dependencies as exact versions, for `make lowest`.

    python tools/lowest_requirements.py

prints one requirement per line: those of the package and of the extras in `EXTRAS`.
"""

import re
import tomllib
from pathlib import Path

EXTRAS = ("compiled", "cubes", "design", "exr", "fits", "raw", "xlsx")
_BOUND = re.compile(r"^([A-Za-z0-9_.-]+)>=([0-9.]+)$")


def lowest(requirement: str) -> str:
    """The lower bound of a requirement as its only version.

    Raises
    ------
    ValueError
        If it has no lower bound.

    Examples
    --------
    >>> lowest("numpy>=1.26")
    'numpy==1.26'
    """
    found = _BOUND.match(requirement)
    if found is None:
        raise ValueError(f"{requirement!r} must have the form name>=version")
    return f"{found[1]}=={found[2]}"


def main() -> None:
    """Print the requirements."""
    text = (Path(__file__).parents[1] / "pyproject.toml").read_text(encoding="utf-8")
    project = tomllib.loads(text)["project"]
    extras = project["optional-dependencies"]
    for requirement in (
        *project["dependencies"],
        *(one for name in EXTRAS for one in extras[name]),
    ):
        if not requirement.startswith("chromanoise["):  # another extra
            print(lowest(requirement))


if __name__ == "__main__":
    main()
