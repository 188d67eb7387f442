"""Count the lines of each package of chromanoise and of each folder of tests.

    python tools/size.py            writes docs/size.toml
    python tools/size.py --check    ends with status 1 where one is larger than that file says

Code lines are those without docstrings, comments and blank lines. A change that needs more lines
writes the file anew, so that its difference shows what it costs.
"""

import ast
import sys
import tomllib
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LEDGER = ROOT / "docs" / "size.toml"
KINDS = ("modules", "code", "docstrings", "javascript")
_HEAD = (
    "# Lines per folder, written by `make size`. CI fails if a folder has more than its numbers "
    "here.\n"
)


def sizes() -> dict[str, dict[str, int]]:
    """Modules, lines of code, of docstrings and of JavaScript by package; tests count as one."""
    found: dict[str, dict[str, int]] = defaultdict(lambda: dict.fromkeys(KINDS, 0))
    package = ROOT / "src" / "chromanoise"
    for top, room in ((package, None), (ROOT / "tests", "tests")):
        for path in sorted([*top.rglob("*.py"), *top.rglob("*.js")]):
            parts = path.relative_to(top).parts
            if path.name == "_version.py":
                continue
            one = found[room or (parts[0] if len(parts) > 1 else "chromanoise")]
            text = path.read_text(encoding="utf-8")
            if path.suffix == ".js":
                one["javascript"] += _script_lines(text)
                continue
            docstrings = _docstring_lines(text)
            one["modules"] += 1
            one["docstrings"] += len(docstrings)
            one["code"] += sum(
                bool(line.strip()) and not line.strip().startswith("#") and number not in docstrings
                for number, line in enumerate(text.splitlines(), 1)
            )
    return dict(sorted(found.items(), key=lambda one: -one[1]["code"]))


def _script_lines(text: str) -> int:
    lines = (line.strip() for line in text.splitlines())
    return sum(bool(line) and not line.startswith(("//", "*", "/*")) for line in lines)


def _docstring_lines(text: str) -> set[int]:
    """Numbers of the lines of docstrings, also of those under assignments."""
    found: set[int] = set()
    left: list[ast.AST] = [ast.parse(text)]
    while left:
        block = left.pop()
        for one in (*getattr(block, "body", ()), *getattr(block, "orelse", ())):
            if not isinstance(one, ast.Expr):
                left.append(one)
            elif isinstance(one.value, ast.Constant) and isinstance(one.value.value, str):
                found |= set(range(one.lineno, (one.end_lineno or one.lineno) + 1))
    return found


def ledger(of: dict[str, dict[str, int]]) -> str:
    """The text of the file."""
    rows = _with_total(of)
    return _HEAD + "".join(
        f'\n["{name}"]\n' + "".join(f"{kind} = {one[kind]}\n" for kind in KINDS if one[kind])
        for name, one in rows.items()
    )


def _with_total(of: dict[str, dict[str, int]]) -> dict[str, dict[str, int]]:
    total = {kind: sum(one[kind] for name, one in of.items() if name != "tests") for kind in KINDS}
    return {"all of src": total, **of}


def larger(of: dict[str, dict[str, int]]) -> list[str]:
    """The packages that are larger than the file says, a sentence each."""
    ceilings = tomllib.loads(LEDGER.read_text(encoding="utf-8"))
    return [
        f"{name} has {one[kind]} ({kind}), and its ceiling is {most}"
        for name, one in _with_total(of).items()
        for kind in ("modules", "code", "javascript")
        if one[kind] > (most := ceilings.get(name, {}).get(kind, 0))
    ]


def main() -> int:
    """Write the file; or compare, and return 1 if a package is larger."""
    found = sizes()
    if "--check" not in sys.argv[1:]:
        LEDGER.write_text(ledger(found), encoding="utf-8")
        return 0
    too_large = larger(found)
    print("\n".join([*too_large, *(["remove lines, or run make size"] if too_large else [])]))
    return 1 if too_large else 0


if __name__ == "__main__":
    sys.exit(main())
