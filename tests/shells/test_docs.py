"""What the documents say is there is there, and what they show runs."""

import importlib
import re
import runpy
import shlex
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_every_function_named_in_the_documents_exists(document):
    for name in re.findall(r"`(chromanoise(?:\.\w+)+)`", document.read_text(encoding="utf-8")):
        module, _, attribute = name.rpartition(".")
        assert attribute in importlib.import_module(module).__all__, name  # a file is no name


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


def readme_commands():
    """The command lines of the README, without comments."""
    lines = "\n".join(readme_blocks("sh")).replace("\\\n", "")
    parts = [part for line in lines.splitlines() for part in line.split("&&")]
    words = [shlex.split(part, comments=True) for part in parts]
    return [one[1:] for one in words if one and one[0] in ("chromanoise", ".venv/bin/chromanoise")]


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
    Path("mine.hdr").write_text(f"ENVI\n{header}byte order = 0\nheader offset = 0\n{waves}")
    np.full((4, 4, nm.size), 0.4, "<f4").tofile("mine.img")
    return here


@pytest.mark.parametrize("words", COMMANDS, ids=" ".join)
def test_each_command_of_the_readme_runs_without_extras(readme_folder, done, without_extras, words):
    done(*words)


def test_the_starter_design_is_searched_without_extras(here, done, without_extras):
    done("init", "--design", "design.toml")
    starter = Path("design.toml").read_text(encoding="utf-8")
    quick = starter.replace("population = 200 ", "population = 8\npolish = false\nseeds = 1 ")
    assert quick != starter
    Path("design.toml").write_text(quick, encoding="utf-8")
    out, _ = done("optimize", "design.toml", "-o", "found", "--budget", 8)
    assert "snr_y_db" in out


def test_the_study_of_the_readme_is_made_run_and_repeated(readme_folder, done):
    commands = [words for words in readme_commands() if words[0] in ("init", "run", "rerun")]
    assert [words[0] for words in commands] == ["init", "run", "rerun"]
    done(*commands[0])
    done("run", "study.toml", "--set", "pictures=[]", "--set", "sweeps=[]")
    done(*commands[2])


@pytest.mark.evidence
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
