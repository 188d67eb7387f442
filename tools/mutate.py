"""Mutation testing: change the physics in one place at a time, and see whether a test fails.

    python tools/mutate.py                   200 mutants
    python tools/mutate.py --count 30 --seed 1 --json found.json
    python tools/mutate.py --again found.json --tests OTHER/tests

A mutant is one changed comparison, operator, sign or constant, one variable returned in place of
another, or one removed statement, drawn at random over the lines of `ROOMS`. The tests near it run
in a copy of this checkout until one fails: first those of the files that import a name of the
changed module, then those that import a module that imports it. A mutant survives if they all pass,
or pass until the time is up; the survivors are printed, for reading. The same seed gives the same
mutants for any folder of tests. ``--again`` runs the mutants of a file of outcomes that were not
killed, e.g. with the tests of another checkout: what these kill, the tests here have lost.
"""

import argparse
import ast
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, fields
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROOMS = ("spectra", "sensor", "noise", "geometry", "color", "metrics")
FARTHEST = 2
"""Most imports between a changed module and what a test file imports."""

_COMPARISONS = {
    ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "==",
    ast.Is: "is not", ast.IsNot: "is", ast.In: "not in", ast.NotIn: "in",
}  # fmt: skip
_OPERATORS = {
    ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Pow: "*", ast.MatMult: "+",
    ast.FloorDiv: "/", ast.Mod: "*", ast.BitAnd: "|", ast.BitOr: "&",
}  # fmt: skip


@dataclass(frozen=True)
class Mutant:
    """One change of a source file.

    Attributes
    ----------
    path
        Of the file, in the checkout.
    line
        Where the change is.
    kind
        ``comparison``, ``operator``, ``sign``, ``constant``, ``variable`` or ``statement``.
    old, new
        The text before and after.
    start, end
        Where the old text is in the file. [bytes]
    """

    path: str
    line: int
    kind: str
    old: str
    new: str
    start: int
    end: int


def mutants_of(path: Path) -> Iterator[Mutant]:
    """All mutants of a file.

    Parameters
    ----------
    path
        Of a module.
    """
    source = path.read_bytes()
    starts = [0]
    for row in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(row))

    def span(node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return (
            starts[node.lineno - 1] + node.col_offset,
            starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def made(node: ast.expr | ast.stmt, kind: str, start: int, end: int, new: str) -> Mutant:
        old = source[start:end].decode()
        name = path.relative_to(ROOT).as_posix()
        return Mutant(name, node.lineno, kind, old, new, start, end)

    for node in _computing(ast.parse(source)):
        if isinstance(node, ast.Compare) and len(node.ops) == 1:
            start, end = span(node.left)[1], span(node.comparators[0])[0]
            new = _COMPARISONS[type(node.ops[0])]
            yield made(node, "comparison", *_bare(source, start, end), new)
        elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            start, end = span(node.left)[1], span(node.right)[0]
            new = _OPERATORS[type(node.op)]
            yield made(node, "operator", *_bare(source, start, end), new)
        elif isinstance(node, ast.UnaryOp):
            yield made(node, "sign", span(node)[0], span(node.operand)[0], "")
        elif isinstance(node, ast.FunctionDef):
            for name, new in _returned_in_place_of_another(node):
                yield made(name, "variable", *span(name), new)
        elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
            yield made(node, "constant", *span(node), repr(_other(node.value)))
        elif isinstance(node, ast.Raise | ast.AugAssign) or (
            isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
        ):
            yield made(node, "statement", *span(node), "pass")


def _computing(tree: ast.Module) -> Iterator[ast.AST]:
    """The nodes that compute: none of annotations, decorators and of the insides of texts."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        for name, value in ast.iter_fields(node):
            if name in ("annotation", "returns", "decorator_list", "type_params") or isinstance(
                value, ast.JoinedStr
            ):
                continue
            inside = value if isinstance(value, list) else [value]
            waiting += [one for one in inside if isinstance(one, ast.AST)]


def _returned_in_place_of_another(function: ast.FunctionDef) -> Iterator[tuple[ast.Name, str]]:
    """Each local variable in what a function returns, and the one that is assigned before it."""
    names = dict.fromkeys(one.arg for one in (*function.args.args, *function.args.kwonlyargs))
    inside = [one for one in ast.walk(function) if isinstance(one, ast.Name)]
    names |= dict.fromkeys(one.id for one in inside if isinstance(one.ctx, ast.Store))
    local = list(names)
    for statement in ast.walk(function):
        if isinstance(statement, ast.Return) and len(local) > 1:
            for one in ast.walk(statement):
                if isinstance(one, ast.Name) and one.id in names:
                    yield one, local[local.index(one.id) - 1]


def _bare(source: bytes, start: int, end: int) -> tuple[int, int]:
    """A range without the blanks, brackets and line ends around the operator inside."""
    text = source[start:end]
    inner = text.strip(b" ()\n\\")
    first = start + text.index(inner)
    return first, first + len(inner)


def _other(value: float) -> float:
    """A number or a truth value in place of a constant."""
    if isinstance(value, bool):
        return not value
    return value + 1 if isinstance(value, int) else (2.0 * value if value else 1.0)


def drawn(count: int, seed: int) -> list[Mutant]:
    """Mutants of all packages, drawn at random.

    Parameters
    ----------
    count
        How many.
    seed
        Of the draw.
    """
    paths = [path for room in ROOMS for path in sorted(_room(room))]
    every = [one for path in paths for one in mutants_of(path)]
    return random.Random(seed).sample(every, min(count, len(every)))


def survivors(outcomes: Path) -> list[Mutant]:
    """The mutants of a file of outcomes that were not killed.

    Parameters
    ----------
    outcomes
        Written by ``--json``, for the sources of this checkout.
    """
    names = [one.name for one in fields(Mutant)]
    rows = json.loads(outcomes.read_text(encoding="utf-8"))
    return [Mutant(**{n: row[n] for n in names}) for row in rows if row["outcome"] != "killed"]


def _room(name: str) -> Iterator[Path]:
    package = ROOT / "src" / "chromanoise"
    yield from (package / name).rglob("*.py")
    yield from package.glob(f"{name}.py")


def _module_of(path: Path) -> str:
    parts = path.relative_to(ROOT / "src").with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _imported(tree: ast.Module) -> set[str]:
    """The modules in which the names are defined that a source imports from the package."""
    found = set[str]()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {one.name for one in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            if node.module.split(".")[0] != "chromanoise":
                found.add(node.module)  # a helper of the tests
                continue
            try:
                package = import_module(node.module)
            except ImportError:  # written by a build, or of an extra that is absent
                continue
            for one in node.names:
                value = getattr(package, one.name, None)
                home = str(getattr(value, "__module__", None) or getattr(value, "__name__", ""))
                found.add(home if home.startswith("chromanoise") else node.module)
    return found


def test_files_near(tests: Path) -> Mapping[str, list[str]]:
    """Files of tests by module: first those near it, of a name like its own, and short.

    Parameters
    ----------
    tests
        The folder of the tests.
    """
    sources = [*(ROOT / "src" / "chromanoise").rglob("*.py")]
    users = defaultdict[str, set[str]](set)  # by module, the modules that import it
    for path in sources:
        for name in _imported(ast.parse(path.read_bytes())):
            users[name].add(_module_of(path))
    helpers = {path.stem: path for path in tests.glob("*.py") if path.stem != "conftest"}
    files = sorted(tests.rglob("test_*.py"))
    of_test = {path: _imported(ast.parse(path.read_bytes())) for path in files}
    for path, names in of_test.items():
        for helper in names & helpers.keys():
            of_test[path] = of_test[path] | _imported(ast.parse(helpers[helper].read_bytes()))
    near = dict[str, list[str]]()
    for name in map(_module_of, sources):
        ring, seen = {name}, {name}
        found = dict[Path, int]()
        for distance in range(FARTHEST + 1):
            for path, names in of_test.items():
                if names & ring:
                    found.setdefault(path, distance)
            ring = {user for one in ring for user in users[one]} - seen
            seen |= ring

        words = set(re.split(r"[._]", name))
        ranks = {
            path: (distance, -len(words & set(path.stem.split("_"))), len(of_test[path]), str(path))
            for path, distance in found.items()
        }
        order = sorted(found, key=ranks.__getitem__)
        near[name] = [path.relative_to(tests).as_posix() for path in order]
    return near


def outcome(mutant: Mutant, copy: Path, files: list[str], limit_s: float) -> tuple[str, float]:
    """What becomes of a mutant, and the elapsed time [s].

    ``killed``, ``survived``, ``untested``, or ``time`` where no test failed within the limit.

    Parameters
    ----------
    mutant
        The change.
    copy
        A copy of the checkout, which is as before when this returns.
    files
        Of tests, in their folder.
    limit_s
        Of elapsed time. [s]
    """
    start = time.monotonic()
    path = copy / mutant.path
    source = path.read_bytes()
    times = path.stat()
    path.write_bytes(source[: mutant.start] + mutant.new.encode() + source[mutant.end :])
    env = os.environ | {"PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": ""}
    words = ["-x", "-q", "-p", "no:cacheprovider", "-n", "0", "--no-header"]
    given = [mutant.path, *(f"tests/{name}" for name in files)]
    process = subprocess.Popen(
        [sys.executable, "-m", "pytest", *words, *given],
        cwd=copy, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip
    try:
        code = process.wait(limit_s)
        found = {0: "survived", 1: "killed", 2: "killed", 5: "untested"}.get(code, "error")
    except subprocess.TimeoutExpired:
        found = "time"
    finally:
        _end_group(process)
        path.write_bytes(source)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))
    return found, time.monotonic() - start


def _end_group(process: subprocess.Popen[bytes]) -> None:
    """End a process with all that it started."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def main() -> None:
    """Draw mutants, run the tests near each, and print what survived."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--limit-s", type=float, default=120.0, help="per mutant")
    parser.add_argument("--tests", type=Path, default=ROOT / "tests", help="folder of the tests")
    parser.add_argument("--again", type=Path, help="file of outcomes, of which to run survivors")
    parser.add_argument("--json", type=Path, help="file of the outcomes so far")
    given = parser.parse_args()
    near = test_files_near(given.tests.resolve())
    outcomes = []
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        copy = Path(folder)
        for name in ("src", "tools", "docs", "examples", "benchmarks"):
            shutil.copytree(ROOT / name, copy / name)
        shutil.copytree(given.tests, copy / "tests")
        for path in ROOT.glob("*.*"):
            if path.is_file():
                shutil.copy2(path, copy)
        mutants = drawn(given.count, given.seed) if given.again is None else survivors(given.again)
        for number, mutant in enumerate(mutants, 1):
            files = near[_module_of(ROOT / mutant.path)]
            result, seconds = outcome(mutant, copy, files, given.limit_s)
            outcomes.append(asdict(mutant) | {"outcome": result, "seconds": round(seconds, 1)})
            change = f"{mutant.old!r} -> {mutant.new!r}"
            print(f"{number} {result} {seconds:.0f} s {mutant.path}:{mutant.line} {change}")
            sys.stdout.flush()
            if given.json is not None:
                given.json.write_text(json.dumps(outcomes, indent=1) + "\n", encoding="utf-8")
    counts = Counter(one["outcome"] for one in outcomes)
    print(f"{counts['killed']} of {len(outcomes)} killed; {dict(counts)}")


if __name__ == "__main__":
    main()
