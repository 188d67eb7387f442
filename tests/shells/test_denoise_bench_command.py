"""``chromanoise denoise-bench``: cells, report with its pictures, refused values."""

import json
import re

import pytest

from chromanoise.apps.denoising_benchmark.benchmark import denoising_benchmark
from chromanoise.base.files import OWN_FILES
from chromanoise.web import write_denoising_report
from outcomes import refused, refused_input

SMALL = {"--sensor": "onyx-rgbw", "--levels": "10", "--crop": "64", "--denoise": "none"}


def words_of(**changed):
    options = SMALL | {f"--{name}": value for name, value in changed.items()}
    return ["builtin:slanted-edges", *(word for pair in options.items() for word in pair)]


def test_cells_report_and_pictures_are_of_the_same_methods(done, tmp_path):
    methods = ("none", "lmmse")
    words = [*words_of(), "--denoise", "lmmse"]
    out = done("denoise-bench", *words, "-o", tmp_path / "out", "--json", tmp_path / "a")
    cells = json.loads((tmp_path / "a").read_text("utf-8"))["cells"]
    assert [cell["method"] for cell in cells] == list(methods)
    assert cells[1]["ciede2000_mean"] < cells[0]["ciede2000_mean"]
    assert f"{cells[0]['ciede2000_mean']:.2f} / " in str(out)
    page = (tmp_path / "out/index.html").read_text("utf-8")
    shown = re.findall(r'<img src="([^"]+)"', page)
    assert shown == ["001-reference.png", "001-none.png", "001-lmmse.png"]
    files = {p.name for p in (tmp_path / "out").iterdir()}
    assert {*shown, "index.html", OWN_FILES} == files


def test_every_seed_has_its_picture(tmp_path):
    cells = denoising_benchmark(
        ["builtin:slanted-edges"], ["onyx-rgbw"], [10.0], ["none"], seeds=(0, 1), crop_px=32
    )
    page = write_denoising_report(cells, tmp_path / "out").read_text("utf-8")
    pictures = [tmp_path / "out" / name for name in re.findall(r'<img src="([^"]+)"', page)]
    assert len({path.read_bytes() for path in pictures}) == 3


def test_a_report_of_no_cell_is_refused(tmp_path):
    with refused_input(subject="cells", value=0):
        write_denoising_report([], tmp_path)


@pytest.mark.parametrize(
    ("name", "value", "part"),
    [
        ("levels", "a", "--levels"),
        ("levels", "-1", "-1"),
        ("processes", "0", "--processes"),
        ("sensor", "nothing", "nothing"),
        ("seed", "-1", "--seed"),
        ("crop", "10", "10"),
    ],
)
def test_values_out_of_range_are_refused(run, name, value, part):
    refused(run("denoise-bench", *words_of(**{name: value})), part)
