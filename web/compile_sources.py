"""Inside the interpreter: compile sources.zip to compiled.zip, and tell what it has inside."""

import importlib.util
import sys
import zipfile
from importlib._bootstrap_external import _code_to_hash_pyc
from pathlib import Path

DATED = (1980, 1, 1, 0, 0, 0)

sources = zipfile.ZipFile("/io/sources.zip")
with zipfile.ZipFile("/io/compiled.zip", "w", zipfile.ZIP_STORED) as compiled:
    for one in sources.infolist():
        name, content = one.filename, sources.read(one)
        # the names of a package are read from the text of its __init__
        if not name.endswith(".py") or name.endswith("__init__.py"):
            compiled.writestr(zipfile.ZipInfo(name, DATED), content)
        if name.endswith(".py"):
            code = compile(content, f"/{name}", "exec", dont_inherit=True, optimize=2)
            hashed = importlib.util.source_hash(content)
            data = _code_to_hash_pyc(code, hashed, checked=False)
            compiled.writestr(zipfile.ZipInfo(f"{name}c", DATED), data)

Path("/io/standard").write_text("\n".join(sorted(sys.stdlib_module_names)), encoding="utf-8")
Path("/io/inside").write_text("\n".join(sys.builtin_module_names), encoding="utf-8")
