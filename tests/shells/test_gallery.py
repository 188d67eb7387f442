"""Each picture of the gallery is drawn by its script, as one figure."""

import ast
import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

import chromanoise as cn
from dear import dear_if

FOLDER = Path(__file__).parents[2] / "docs" / "gallery"
SCRIPTS = sorted(FOLDER.glob("plot_*.py"))


@pytest.mark.evidence
@pytest.mark.parametrize(
    "path", dear_if(lambda path: "front" in path.stem, SCRIPTS), ids=lambda path: path.stem
)
def test_a_script_draws_one_figure_with_text_on_it(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    search = cn.optimize  # to fewer candidates: `make docs` draws the whole front
    monkeypatch.setattr(cn, "optimize", lambda path, budget: search(path, budget=budget // 8))
    plt.switch_backend("agg")
    plt.close("all")
    try:
        runpy.run_path(str(path), run_name="__main__")
        (number,) = plt.get_fignums()
        figure = plt.figure(number)
        for ax in figure.axes:
            labels = [
                ax.get_xlabel(),
                ax.get_ylabel(),
                *(ax.get_title(loc=side) for side in ("left", "center", "right")),
            ]
            assert any(labels), "a panel without title or label"
        assert not list(tmp_path.iterdir())
    finally:
        plt.close("all")


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_has_a_title_two_sentences_and_public_imports(path):
    tree = ast.parse(path.read_text("utf-8"))
    title, rule, empty, *text = ast.get_docstring(tree).splitlines()
    assert rule == "=" * len(title)
    assert not empty
    assert " ".join(text).count(". ") + 1 >= 2
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module.startswith("chromanoise"):
            assert node.module.removeprefix("chromanoise.apps").count(".") <= 1, node.module
            assert "._" not in node.module, node.module


def test_the_gallery_has_20_pictures_and_a_header():
    assert len(SCRIPTS) >= 20
    assert (FOLDER / "GALLERY_HEADER.rst").read_text("utf-8").startswith("Gallery\n=======\n")
