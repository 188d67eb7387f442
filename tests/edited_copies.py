"""A copy of the package with small edits, and what a script prints that runs with it."""

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import chromanoise
from processes import printed

ROOT = Path(__file__).parents[1]


def edit_copy(
    folder: Path, edits: Mapping[str, tuple[str, ...]], modules: Mapping[str, str]
) -> None:
    """Make the copy in ``folder``, with further ``modules``.

    Each edit writes a text before another one, which its file of the package must contain once;
    a file may have several edits one after the other.
    """
    copy = folder / "chromanoise"
    # its bytecode is kept: else each process compiles all sources again
    ignored = shutil.ignore_patterns("kernels-*", "*.pyi")
    shutil.copytree(Path(chromanoise.__file__).parent, copy, ignore=ignored)
    for name, module in modules.items():
        (copy / name).write_text(module, encoding="utf-8")
    for name, edit in edits.items():
        path = copy / name
        for before, text in zip(edit[::2], edit[1::2], strict=True):
            old = path.read_text(encoding="utf-8")
            assert old.count(before) == 1, (name, before)
            path.write_text(old.replace(before, text + before), encoding="utf-8")


def answers_of_copy(
    folder: Path, edits: Mapping[str, tuple[str, ...]], script: str, modules: Mapping[str, str] = {}
) -> dict[str, Any]:
    """The JSON of the last line that ``script`` prints with a copy that is made in ``folder``."""
    edit_copy(folder, edits, modules)
    path = os.pathsep.join(map(str, (folder, ROOT / "tools", ROOT / "docs" / "_ext")))
    cache = str(folder / "cache")
    told = printed(script, cwd=folder, PYTHONPATH=path, CHROMANOISE_CACHE=cache, COLUMNS="100")
    return json.loads(told.splitlines()[-1])
