"""Citation, version, man pages and completion of the command line."""

import platform
import re
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest
import yaml

import chromanoise
import make_man
from processes import printed

ROOT = Path(__file__).parents[2]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
NEEDED = [
    "numpy>=1.26",
    "no-such-package>=1; extra == 'raw'",
    "pytest>=8; extra == 'dev'",
    "chromanoise[raw]; extra == 'dev'",
]


def bibtex(text):
    """The fields of each entry, by its key."""
    entries = re.findall(r"^@(\w+)\{(\w+),\n(.*?)^\}$", text, flags=re.DOTALL | re.MULTILINE)
    return {
        key: {"kind": kind} | dict(re.findall(r"^  (\w+) += \{(.*)\},$", body, flags=re.MULTILINE))
        for kind, key, body in entries
    }


def test_cite_gives_the_program_and_the_paper_of_the_citation_file(done):
    printed = bibtex(done("cite", "--bibtex")[0])
    assert set(printed) == {"chromanoise", "clouet2019"}
    program, paper = printed["chromanoise"], printed["clouet2019"]
    assert program["kind"] == "software"
    assert program["version"] == chromanoise.__version__
    assert program["author"] == f"{{{CITATION['authors'][0]['name']}}}"
    assert program["year"] == str(CITATION["date-released"].year)
    assert program["license"] == CITATION["license"]
    (cited,) = CITATION["references"]
    assert paper["kind"] == "inproceedings"
    assert paper["title"] == f"{{{cited['title']}}}"
    assert paper["year"] == str(cited["year"])
    names = [one["family-names"] for one in cited["authors"]]
    assert re.findall(r"(\w+), ", paper["author"]) == names


def test_cite_without_an_option_gives_one_line_for_each(done):
    program, paper = done("cite")[0].splitlines()
    assert chromanoise.__version__ in program
    assert CITATION["references"][0]["title"] in paper


def test_the_version_names_the_installed_packages_and_the_missing_ones(done, monkeypatch):
    monkeypatch.setattr(metadata, "requires", lambda _: NEEDED)
    first, python, *groups = done("--version")[0].splitlines()
    assert first == f"chromanoise {chromanoise.__version__}"
    assert python.split()[1] == platform.python_version()
    assert [re.split(r" {2,}", line, maxsplit=1) for line in groups] == [
        ["required", f"numpy {np.__version__}"],
        ["raw", "no-such-package missing"],
    ]


def test_the_man_pages_are_those_of_the_commands():
    """`python tools/make_man.py` writes them anew."""
    committed = {p.name: p.read_text(encoding="utf-8") for p in (ROOT / "docs/man").glob("*.1")}
    assert make_man.man_pages() == committed


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_gets_a_completion_of_the_commands(shell):
    words = {"COMP_WORDS": "chromanoise cit", "COMP_CWORD": "cit" if shell == "fish" else "1"}
    asked = {"_CHROMANOISE_COMPLETE": f"{shell}_complete"} | words
    completed = printed("from chromanoise.cli import main; main()", **asked)
    assert "cite" in re.split(r"[\s,]+", completed)
