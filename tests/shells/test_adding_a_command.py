"""A command costs one module and one line; help, completion, man pages and reference follow."""

import pytest

from edited_copies import answers_of_copy

MODULE = '''"""``chromanoise list-channels``: names of channels."""

import click

import chromanoise as cn
from chromanoise.cli.options import command


@command()
@click.argument("sensor")
@click.option("--lux", type=float, default=10.0, show_default=True, help="Illuminance [lx].")
def list_channels(sensor: str, lux: float) -> None:
    """Print the names of the channels of SENSOR, if it sees anything."""
    click.echo(" ".join(cn.analyze(sensor, lux=lux).points[0].sensor.names))
'''
LINE = '    "list-channels": ("list_channels", "Names of the channels of a sensor."),\n'
BEFORE = '    "catalog": ('
QUESTIONS = """
import contextlib, importlib.util, io, json, os, sys
from chromanoise.cli.entry import run

def printed(*words):
    out, err, code = io.TextIOWrapper(io.BytesIO()), io.StringIO(), None
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            run(list(words))
        except SystemExit as stop:
            code = stop.code
    out.flush()
    return [code, out.buffer.getvalue().decode(), err.getvalue()]

found = {
    "list": printed("--help")[1],
    "help": printed("list-channels", "--help")[1],
    "run": printed("list-channels", "onyx-rgb-ircut"),
    "refused": printed("list-channels", "onyx-rgb-ircut", "--lux", "-1"),
    "near": printed("list-channel")[2],
}
if importlib.util.find_spec("click_man"):
    import make_man
    found["man"] = sorted(make_man.man_pages())
if importlib.util.find_spec("sphinx"):
    import reference_pages
    found["reference"] = reference_pages.command_pages()
os.environ |= {
    "_CHROMANOISE_COMPLETE": "bash_complete", "COMP_WORDS": "chromanoise lis", "COMP_CWORD": "1"
}
found["completed"] = printed()[1]
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    """What a copy of the package with the new command answers."""
    folder, modules = tmp_path_factory.mktemp("copy"), {"cli/list_channels.py": MODULE}
    return answers_of_copy(folder, {"cli/entry.py": (BEFORE, LINE)}, QUESTIONS, modules)


@pytest.mark.evidence
def test_the_help_lists_it_with_its_line_and_its_options(answers):
    assert "list-channels" in answers["list"]
    assert "Names of the channels of a sensor." in " ".join(answers["list"].split())
    assert "--lux FLOAT" in answers["help"]


@pytest.mark.evidence
def test_it_runs_and_its_errors_are_sentences(answers):
    assert answers["run"][0] == 0
    assert answers["run"][1].split() == ["R", "G", "B"]
    code, out, err = answers["refused"]
    assert (code, out) == (2, "")
    assert err.startswith("chromanoise: --lux must be greater than 0")
    assert "did you mean list-channels?" in answers["near"]


def test_completion_man_pages_and_the_reference_have_it(answers):
    assert "list-channels" in answers["completed"]
    if "man" in answers:
        assert "chromanoise-list-channels.1" in answers["man"]
    if "reference" in answers:
        assert "--lux" in answers["reference"]["list-channels"]
        assert "chromanoise list-channels" in answers["reference"]["index"]
