"""The tutorials run from top to bottom, and the numbers in their text are those they compute."""

import json
import re
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from dear import dear_if

FOLDER = Path(__file__).parents[2] / "docs" / "tutorials"
NOTEBOOKS = {path.stem: json.loads(path.read_text("utf-8")) for path in FOLDER.glob("*.ipynb")}
FIGURES = {"designer": 6, "isp_engineer": 3, "color_scientist": 2, "teacher": 6}


def sources(notebook, kind):
    return ["".join(one["source"]) for one in notebook["cells"] if one["cell_type"] == kind]


def prose(notebook):
    return " ".join("\n".join(sources(notebook, "markdown")).split())


def claims_of_designer(space):
    (mine, rival), *_ = space["over_light"].crossovers[0].color_error
    yield "Read noise and PRNU cost less than half a decibel each"
    assert max(c.cost_db for c in space["budget"].costs if c.cause in ("read noise", "PRNU")) < 0.5
    error = space["result"].to_dict()["sensors"][0]["color_error_mean"]
    yield f"a mean color error of {error:.0f}"
    yield f"below {space['break_even_lux']['kernel']:.1f} lx"
    yield f"a color error of {mine:.0f} against {rival:.1f}"
    yield f"near {space['break_even_lux']['lmmse']:.2f} lx"


def claims_of_isp_engineer(space):
    noise = space["noise"]
    assert 1.8 < noise[400].min() / noise[100].min() < 2.1
    yield "Where shot noise prevails the noise doubles"


def claims_of_color_scientist(space):
    yield f"its angle to their span is only {space['rgbw'].mix.angle_deg:.0f} degrees"
    yield f"so its VIF is {space['rgbw'].vif[3]:.1f}"
    yield f"its SNR rises by {space['gain_db']:.1f} dB"
    yield f"a color error of {space['bare'].ciede2000[0]:.0f}"
    sds = [one.noise.measurement.covariance[:, 2, 2] for one in (space["bare"], space["cut"])]
    assert (sds[0] > sds[1]).all()
    yield "The noise in b* is larger without IR-cut on every sample"


def claims_of_teacher(space):
    yield f"At 60 degrees unmixing costs {-space['loss_db'](60):.0f} dB"
    yield f"at 10 degrees {-space['loss_db'](10):.0f} dB"
    luminance = space["luminance_db"]
    yield f"worse color picture by {luminance['onyx-rgb-ircut'] - luminance['onyx-rgbw']:.1f} dB"
    yield f"below {space['at_lux']:.2f} lx"


CLAIMS = {
    "designer": claims_of_designer,
    "isp_engineer": claims_of_isp_engineer,
    "color_scientist": claims_of_color_scientist,
    "teacher": claims_of_teacher,
}


def test_there_is_one_tutorial_per_reader_and_the_index_names_it():
    index = (FOLDER / "index.md").read_text("utf-8")
    assert set(NOTEBOOKS) == set(CLAIMS)
    assert set(re.findall(r"\((\w+)\.ipynb\)", index)) == set(NOTEBOOKS)


@pytest.mark.parametrize("name", CLAIMS)
def test_a_tutorial_is_stored_without_outputs(name):
    notebook = NOTEBOOKS[name]
    assert (notebook["nbformat"], notebook["nbformat_minor"]) == (4, 5)
    ids = [one["id"] for one in notebook["cells"]]
    assert len(set(ids)) == len(ids)
    for one in notebook["cells"]:
        assert not one.get("outputs")
        assert one.get("execution_count") is None


@pytest.mark.parametrize("name", CLAIMS)
def test_a_tutorial_uses_only_public_names(name):
    for module in re.findall(
        r"(?:from|import) chromanoise\.(\S+)", "\n".join(sources(NOTEBOOKS[name], "code"))
    ):
        assert not module.startswith("_"), module
        assert "." not in module.removeprefix("apps."), module


@pytest.mark.parametrize("name", dear_if(("isp_engineer", "designer").__contains__, CLAIMS))
def test_a_tutorial_runs_and_its_text_states_what_it_computes(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    plt.switch_backend("agg")
    plt.close("all")
    space = {}
    try:
        for i, source in enumerate(sources(NOTEBOOKS[name], "code")):
            code = source.removeprefix("%matplotlib inline\n")
            exec(compile(code, f"{name}, code cell {i}", "exec"), space)
        assert len(plt.get_fignums()) == FIGURES[name]
    finally:
        plt.close("all")
    assert capsys.readouterr().out
    text = prose(NOTEBOOKS[name])
    for claim in CLAIMS[name](space):
        assert claim in text, claim
