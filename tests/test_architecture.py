"""The house of docs/design.md: folders in the order of the light, nothing heavy at the door."""

import ast
import os
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

import size
from chromanoise.cli import main
from processes import printed

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "chromanoise"


def imported_by(statement: str) -> set[str]:
    script = f"import sys\n{statement}\nprint('\\n'.join(sys.modules))"
    return set(printed(script).split())


def parsed_with(word, *, but):
    """The modules other than one that contain a word, and their trees."""
    for path in set(PACKAGE.rglob("*.py")) - {PACKAGE / but, PACKAGE / "base" / "__init__.py"}:
        text = path.read_text(encoding="utf-8")
        if word in text:
            yield path, ast.parse(text)


def test_importing_the_package_imports_nothing_heavy():
    heavy = {"numpy", "scipy", "colour", "matplotlib", "rich", "click", "jinja2"}
    assert not heavy & imported_by("import chromanoise")


def test_help_does_not_pay_for_the_color_library_nor_for_drawing():
    heavy = {"colour", "matplotlib", "scipy", "rich", "chromanoise.spectra"}
    assert not heavy & imported_by("import chromanoise.cli")


def test_analyze_imports_no_library_that_it_does_not_use():
    """The largest of them, matplotlib, would take more time than all the rest together."""
    unused = {
        *("PIL", "asyncio", "astropy", "beartype", "colour", "dask", "h5py", "jaxtyping", "jinja2"),
        *(
            "llvmlite",
            "matplotlib",
            "numba",
            "openpyxl",
            "pandas",
            "scipy",
            "starlette",
            "tifffile",
        ),
        *("unittest", "uvicorn", "xarray", "zarr"),
    }
    imported = imported_by(
        "import contextlib, io\n"
        "from chromanoise.cli import main\n"
        "with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()) as told:\n"
        "    main(['analyze', 'onyx-rgbw'])\n"
        "assert 'onyx-rgbw' in told.getvalue()"
    )
    assert "chromanoise.study.analysis" in imported
    assert not unused & imported


def test_a_run_without_a_report_loads_no_templates(tmp_path):
    study = tmp_path / "one.toml"
    study.write_text('schema = 1\n[[sensors]]\nname = "onyx-rgb"\n', encoding="utf-8")
    arguments = ["run", str(study), "-o", str(tmp_path / "out")]
    imported = imported_by(
        "import contextlib, io\n"
        "from chromanoise.cli import main\n"
        "with contextlib.suppress(SystemExit), contextlib.redirect_stdout(io.StringIO()):\n"
        f"    main({arguments})"
    )
    assert (tmp_path / "out" / "study.json").exists()
    assert "jinja2" not in imported


@pytest.mark.parametrize(("given", "used"), [(None, "1"), ("2", "2")])
def test_a_command_has_one_thread_of_openblas_unless_told_otherwise(monkeypatch, given, used):
    name = "OPENBLAS_NUM_THREADS"
    monkeypatch.setenv(name, given or "")
    if given is None:
        monkeypatch.delenv(name)
    with pytest.raises(SystemExit):
        main(["--version"])
    assert os.environ[name] == used


LIGHT = """
import importlib, sys
from importlib.abc import MetaPathFinder

class Others(MetaPathFinder):
    def find_spec(self, name, path, target=None):
        top = name.partition(".")[0]
        known = {"numpy", "scipy", "chromanoise", *sys.stdlib_module_names}
        if path is None and top not in known and not top.startswith("_sysconfigdata"):
            raise ImportError(f"{name} is blocked")

sys.meta_path.insert(0, Others())
import chromanoise as cn
for room in ("base", "spectra", "sensor", "noise", "geometry", "color", "metrics", "study"):
    module = importlib.import_module(f"chromanoise.{room}")
    for name in module.__all__:
        getattr(module, name)
results = [
    cn.analyze("onyx-rgbw", "model-rgb", budget=True, matrix="lmmse"),
    cn.compare("onyx-rgbw", points=3),
    cn.matrix("onyx-rgb-ircut", matrix="white-preserving"),
]
for one in results:
    print(one.to_dict(), one.to_table(), one.to_latex(), one._repr_html_(), one)
"""


def test_stages_analyze_compare_and_matrix_need_numpy_and_scipy_alone():
    printed(LIGHT)


def test_every_direct_dependency_is_used_and_says_why():
    """jaxtyping is for type checkers, and what imports it first."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    block = text.partition("\ndependencies = [\n")[2].partition("]\n")[0]
    lines = [re.fullmatch(r' +"([a-z0-9-]+)>=[0-9.]+", +# \S.*', one) for one in block.splitlines()]
    assert all(lines)
    assert len(lines) <= 12
    modules = {"pillow": "PIL"}
    sources = [path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")]
    for one in lines:
        name = modules.get(one[1], one[1])
        assert any(re.search(rf"^ *(import|from) {name}\b", text, re.M) for text in sources), name


def test_importing_every_module_removes_no_file():
    """Audit events: https://docs.python.org/3/library/audit_events.html."""
    names = [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.name != "__init__.py"
    ]
    script = f"""
import importlib, os, sys
events = {{"os.remove", "os.rmdir", "shutil.rmtree", "os.truncate"}}
removed, probes = [], set()  # a probe is made and removed to see whether a folder can be written
def hook(event, args):
    if event == "open" and args[2] & os.O_EXCL:
        probes.add(args[0])
    if event in events and args[0] not in probes:
        removed.append((event, str(args[0])))
sys.addaudithook(hook)
for name in {names}:
    importlib.import_module(name)
assert not removed, removed
"""
    printed(script)


def test_every_folder_is_named_in_the_map_of_the_package():
    import chromanoise

    folders = {p.parent.name for p in PACKAGE.glob("*/__init__.py")}
    named = {folder for folder in folders if f"``{folder}``" in (chromanoise.__doc__ or "")}
    assert named == folders


def test_no_two_modules_have_one_name():
    names = [path.name for path in PACKAGE.rglob("*.py") if path.name != "__init__.py"]
    assert [name for name in set(names) if names.count(name) > 1] == []


def test_no_module_but_one_calls_a_linear_solver():
    """LAPACK may loop forever over a number that is not finite; `linalg` checks first."""
    found = set()
    for path, tree in parsed_with("linalg", but="base/linalg.py"):
        for node in ast.walk(tree):
            names = []
            if isinstance(node, ast.ImportFrom):
                names = [f"{node.module}.{alias.name}" for alias in node.names]
            elif isinstance(node, ast.Attribute):
                names = [ast.unparse(node)]
            called = {name for one in names for name in re.findall(r"(?<!_)linalg\.(\w+)", one)}
            found |= {f"{path.name}: {name}" for name in called - {"norm"}}
    assert found == set()


def test_no_module_resolves_a_path_with_an_error_for_links_in_a_loop():
    """`Path.resolve` raises RuntimeError for them; `inputs.true_path` does not."""
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert {path.name for path, text in texts.items() if ".resolve()" in text} == set()


def test_no_module_but_one_parses_json():
    """`inputs.json_of` refuses what a later step could not use; `json.loads` does not."""
    called, imported = set(), set()
    for path, tree in parsed_with("json", but="base/inputs.py"):
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module == "json":
                imported.add(path.name)
            elif isinstance(node, ast.Attribute) and node.attr in ("load", "loads", "JSONDecoder"):
                called |= {path.name} if ast.unparse(node.value) == "json" else set()
    assert (called, imported) == (set(), set())


def test_no_module_but_one_generates_the_methods_of_a_class():
    """The standard decorator takes 0.2 ms per class, at each start; that of `base` does not."""
    standard = re.compile(
        r"^(from dataclasses import .*\b(make_)?dataclass\b|import dataclasses)", re.M
    )
    texts = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    assert {path.name for path, text in texts.items() if standard.search(text)} == {"immutable.py"}


MOST_MODULES = {"prnu": 12, "row_noise_e": 6}
"""Modules that may name a property of the pixel; a number here may only fall."""


@pytest.mark.parametrize("name", MOST_MODULES)
def test_a_property_of_the_pixel_is_named_in_few_modules(name):
    sources = [*PACKAGE.rglob("*.py"), *PACKAGE.rglob("*.js")]
    naming = [one for one in sources if re.search(rf"\b{name}\b", one.read_text("utf-8"))]
    assert len(naming) <= MOST_MODULES[name], sorted(naming)


@pytest.fixture(scope="module")
def sizes():
    return size.sizes()


def test_no_room_is_larger_than_its_ceiling(sizes):
    """`make size` writes `docs/size.toml` anew: its difference shows what a change costs."""
    assert not size.larger(sizes)


def test_a_line_more_is_found(monkeypatch, sizes):
    grown = {name: dict(one) for name, one in sizes.items()}
    stored = {name: dict(one) for name, one in grown.items()}
    grown["noise"]["code"] += 1
    monkeypatch.setattr(size, "LEDGER", SimpleNamespace(read_text=lambda **_: size.ledger(stored)))
    assert [sentence.partition(" ")[0] for sentence in size.larger(grown)] == ["all", "noise"]
