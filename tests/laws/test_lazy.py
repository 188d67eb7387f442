"""Packages whose names are imported on first use."""

import ast
import sys
from importlib import import_module
from pathlib import Path

import pytest

from chromanoise.base.lazy import lazy_names
from processes import printed

PACKAGE = Path(import_module("chromanoise").__file__ or "").parent
LAZY = sorted(
    ".".join(path.parent.relative_to(PACKAGE.parent).parts)
    for path in PACKAGE.rglob("__init__.py")
    if "lazy_names(__name__)" in path.read_text(encoding="utf-8")
)


def imports_at_once(package):
    """Whether its ``__init__`` also imports names when it is imported itself."""
    source = (PACKAGE.parent / package.replace(".", "/") / "__init__.py").read_text("utf-8")
    modules = [node.module for node in ast.parse(source).body if isinstance(node, ast.ImportFrom)]
    return any(module.startswith(f"{package}.") for module in modules)


WHOLLY_LAZY = [package for package in LAZY if not imports_at_once(package)]
EMPTY = "chromanoise.apps"  # a package without names
SAMPLE = """
from typing import TYPE_CHECKING
from {package}.base.lazy import lazy_names
if TYPE_CHECKING:
    from math import tau as circle
    from math import e as e
    from sample.heavy import made
    from sample import heavy
__getattr__, __dir__, __all__ = lazy_names(__name__)
""".format(package="chromanoise")


@pytest.fixture
def sample(tmp_path, monkeypatch):
    (tmp_path / "sample").mkdir()
    (tmp_path / "sample" / "__init__.py").write_text(SAMPLE)
    (tmp_path / "sample" / "heavy.py").write_text("made = [1]\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield import_module("sample")
    for name in ("sample", "sample.heavy"):
        sys.modules.pop(name, None)


def test_a_name_is_imported_on_its_first_use_and_then_kept(sample):
    assert "sample.heavy" not in sys.modules
    assert sample.made == [1]
    assert sample.made is sys.modules["sample.heavy"].made
    assert "made" in vars(sample)


def test_a_name_may_be_renamed_or_be_a_submodule(sample):
    assert sample.circle == pytest.approx(6.283185307179586)
    assert sample.heavy is import_module("sample.heavy")


def test_names_that_are_imported_as_themselves_are_the_public_ones(sample):
    assert sample.__all__ == ["e"]
    assert not hasattr(import_module("sample.heavy"), "__all__")


def test_dir_lists_names_before_they_are_imported(sample):
    assert {"circle", "heavy", "made", "__name__"} <= set(dir(sample))
    assert "sample.heavy" not in sys.modules


def test_an_unknown_name_is_an_attribute_error_that_names_the_package(sample):
    with pytest.raises(AttributeError, match="module 'sample' has no attribute 'nothing'"):
        sample.nothing  # noqa: B018


def test_a_package_without_its_source_is_refused(sample):
    (Path(sample.__file__)).unlink()
    with pytest.raises((ImportError, OSError)):
        lazy_names("sample")


@pytest.mark.parametrize("package", LAZY)
def test_a_lazy_package_exports_what_its_type_checking_imports_name(package):
    module = import_module(package)
    for name in module.__all__:
        assert getattr(module, name) is not None
    assert set(module.__all__) <= set(dir(module))


@pytest.mark.parametrize("package", LAZY)
def test_no_name_of_a_lazy_package_is_hidden_by_a_submodule(package):
    """The import of a submodule sets an attribute of its package, in place of the lazy name."""
    folder = Path(import_module(package).__file__ or "").parent
    submodules = {p.stem for p in folder.glob("*.py")} | {
        p.parent.name for p in folder.glob("*/*.py")
    }
    source = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
    lazily = [
        node
        for block in source.body
        if isinstance(block, ast.If)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
    ]
    named = {alias.asname or alias.name: node.module for node in lazily for alias in node.names}
    assert {name for name in submodules & set(named) if named[name] != package} == set()


@pytest.mark.parametrize("package", WHOLLY_LAZY)
def test_a_lazy_package_alone_imports_no_numpy(package):
    """Only its parents and the helper; numpy stands for all that its names need."""
    script = f"import sys, {package}\nprint('numpy' in sys.modules)"
    parents = [package.rsplit(".", k)[0] for k in range(1, package.count("."))]
    expected = any(parent not in (*WHOLLY_LAZY, EMPTY) for parent in parents)
    assert printed(script).strip() == str(expected)
