"""What the documents say is there is there, and what they show runs."""

import importlib
import re
import runpy
import shlex
import sys
import textwrap
import tomllib
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_function_named_in_the_documents_exists(document):
    for name in re.findall(r"`(chromanoise(?:\.\w+)+)`", document.read_text(encoding="utf-8")):
        module, _, attribute = name.rpartition(".")
        assert hasattr(importlib.import_module(module), attribute), name


def test_the_readme_stays_under_150_lines():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) < 150


README = (ROOT / "README.md").read_text(encoding="utf-8")


def readme_blocks(kind):
    return re.findall(rf"^```{kind}\n(.*?)^```", README, flags=re.DOTALL | re.MULTILINE)


def test_the_readme_script_prints_what_the_readme_says(capsys):
    script, plotted = readme_blocks("python")
    promised = re.findall(r"^# (.*)$", script, flags=re.MULTILINE)
    assert [line for line in script.splitlines() if "import" in line] == [
        "import chromanoise as cn"
    ]
    exec(compile(script, "README.md", "exec"), {})
    assert capsys.readouterr().out.splitlines() == promised
    assert plotted.startswith("axes = over_light.plot()")


def test_the_readme_plots_what_it_computed():
    space = {}
    script, plotted = readme_blocks("python")
    exec(compile(script.replace("print(", "str("), "README.md", "exec"), space)
    exec(compile(plotted, "README.md", "exec"), space)
    assert space["axes"].lines


def commands_in(text):
    """The words of each command line, without comments."""
    lines = text.replace("\\\n", "").splitlines()
    words = [shlex.split(part, comments=True) for line in lines for part in line.split("&&")]
    return [one[1:] for one in words if one and one[0] in ("chromanoise", ".venv/bin/chromanoise")]


def readme_commands():
    return commands_in("\n".join(readme_blocks("sh")))


MODULES = {
    "bm3d": "bm3d",
    "cma": "cma",
    "dask": "dask",
    "distributed": "distributed",
    "astropy": "astropy",
    "h5netcdf": "h5netcdf",
    "h5py": "h5py",
    "imagecodecs": "imagecodecs",
    "opencv-python-headless": "cv2",
    "openexr": "OpenEXR",
    "openpyxl": "openpyxl",
    "pandas": "pandas",
    "pymoo": "pymoo",
    "pywavelets": "pywt",
    "rawpy": "rawpy",
    "scikit-image": "skimage",
    "torch": "torch",
    "xarray": "xarray",
    "zarr": "zarr",
}
EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
    "optional-dependencies"
]
OF_USERS = [packages for name, packages in EXTRAS.items() if name not in ("bench", "dev", "docs")]


@pytest.fixture
def alone(monkeypatch):
    """As after ``pip install chromanoise``: no package of an extra can be imported."""
    names = {re.split("[><=]", one)[0] for packages in OF_USERS for one in packages}
    assert names == set(MODULES)
    for name in [one for one in sys.modules if one.split(".")[0] in MODULES.values()]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "meta_path", [_Without(finder) for finder in sys.meta_path])


class _Without:
    """A finder of modules that finds none of an extra."""

    def __init__(self, finder):
        self.finder = finder

    def find_spec(self, name, path=None, target=None):
        found = name.split(".")[0] not in MODULES.values()
        return self.finder.find_spec(name, path, target) if found else None

    def __getattr__(self, name):
        return getattr(self.finder, name)


LONG = ("reproduce", "rerun", "run", "characterize")  # minutes, or for the sake of another
COMMANDS = [words for words in readme_commands() if words[0] not in (*LONG, "serve")]


@pytest.fixture
def readme_folder(here):
    """A folder with the files that the README names."""
    nm = np.arange(400, 1051, 10)
    rows = [f"{w},{0.1 + 0.3 * (w > 590)},{0.4 * (500 < w < 590)},{0.3 * (w < 500)}" for w in nm]
    Path("mine.csv").write_text("\n".join(["wavelength_nm,R,G,B", *rows]))
    header = f"samples = 4\nlines = 4\nbands = {nm.size}\ndata type = 4\ninterleave = bip\n"
    waves = f"wavelength units = nm\nwavelength = {{{', '.join(map(str, nm))}}}\n"
    Path("cube.hdr").write_text(f"ENVI\n{header}byte order = 0\nheader offset = 0\n{waves}")
    np.full((4, 4, nm.size), 0.4, "<f4").tofile("cube.img")
    return here


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_each_command_of_the_readme_runs_without_extras(readme_folder, done, alone, words):
    done(*words)


BLOCK = re.compile(r"^( *)```(\w+)(?: file=(\S+))?\n(.*?)^ *```", re.DOTALL | re.MULTILINE)
SLOW = ("characterize.md", "denoising.md", "sensitivity.md", "cluster.md", "own_matrix.md")
GUIDES = [
    pytest.param(path, id=path.name, marks=pytest.mark.evidence if path.name in SLOW else ())
    for path in DOCUMENTS[2:]
    if commands_in("\n".join(one[3] for one in BLOCK.findall(path.read_text("utf-8"))))
]


@pytest.mark.parametrize("document", GUIDES)
def test_each_command_of_a_guide_runs_without_extras(readme_folder, done, alone, document):
    for _, kind, file, text in BLOCK.findall(document.read_text("utf-8")):
        own = textwrap.dedent(text)
        if file:
            Path(file).write_text(own, encoding="utf-8")
        for words in commands_in(own) if kind == "sh" else ():
            if words[0] != "serve":
                done(*words)


def test_the_starter_design_is_searched_without_extras(here, done, alone):
    done("init", "--design", "design.toml")
    out, _ = done("optimize", "design.toml", "-o", "found", "--budget", 400)
    assert "snr_y_db" in out


def test_the_study_of_the_readme_is_made_run_and_repeated(readme_folder, done):
    commands = [words for words in readme_commands() if words[0] in ("init", "run", "rerun")]
    assert [words[0] for words in commands] == ["init", "run", "rerun"]
    done(*commands[0])
    done("run", "study.toml", "--set", "pictures=[]", "--set", "sweeps=[]")
    done(*commands[2])


def test_the_frames_of_the_readme_are_made_and_characterized(readme_folder, done):
    for words in readme_commands():
        if words[0] in ("demo-frames", "characterize"):
            done(*words)


@pytest.mark.evidence
def test_the_paper_is_reproduced_by_the_command_of_the_readme(readme_folder, done):
    (words,) = [words for words in readme_commands() if words[0] == "reproduce"]
    done(*words)


@pytest.mark.parametrize("path", sorted((ROOT / "examples").glob("*.py")), ids=lambda p: p.stem)
def test_every_example_runs_and_its_own_assertions_hold(path, capsys):
    runpy.run_path(str(path), run_name="__main__")
    assert capsys.readouterr().out
