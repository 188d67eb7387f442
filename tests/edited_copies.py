"""A copy of the package with small edits, and what a script prints that runs with it."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import chromanoise

ROOT = Path(__file__).parents[1]


def answers_of_copy(
    folder: Path, edits: Mapping[str, tuple[str, ...]], script: str, **modules: str
) -> dict[str, Any]:
    """The JSON of the last line that ``script`` prints.

    Each edit writes a text before another one, which its file of the package must contain once;
    a file may have several edits one after the other. ``modules`` are further ones of `io`.
    """
    copy = folder / "chromanoise"
    # its bytecode is kept: else each process compiles all sources again
    ignored = shutil.ignore_patterns("kernels-*", "*.pyi")
    shutil.copytree(Path(chromanoise.__file__).parent, copy, ignore=ignored)
    for name, module in modules.items():
        (copy / "io" / f"{name}.py").write_text(module, encoding="utf-8")
    for name, edit in edits.items():
        path = copy / name
        for before, text in zip(edit[::2], edit[1::2], strict=True):
            old = path.read_text(encoding="utf-8")
            assert old.count(before) == 1
            path.write_text(old.replace(before, text + before), encoding="utf-8")
    own = {"PYTHONPATH": f"{folder}{os.pathsep}{ROOT / 'docs' / '_ext'}"}
    found = subprocess.run(
        [sys.executable, "-c", script],
        env=os.environ | own | {"CHROMANOISE_CACHE": str(folder / "cache")},
        cwd=folder, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    return json.loads(found.stdout.splitlines()[-1])
