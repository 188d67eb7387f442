"""`init --design`, `optimize`, `cn.optimize`: a front whose members every command takes."""

import io
import json
import os
import shlex
import shutil
import sys
from contextlib import redirect_stdout

import pytest

import chromanoise as cn
from chromanoise.apps.design import DESIGN_STARTER
from chromanoise.base.files import OWN_FILES
from chromanoise.cli import main
from outcomes import refused

OF_CHART = DESIGN_STARTER.replace('["kernel"]', '["lmmse"]\nprior = "chart"')  # few reflectances
SHORT = OF_CHART.replace("population = 200", "population = 8\nseeds = 1\npolish = false")
EFFORT = ("--budget", "32")


@pytest.fixture
def design(here):
    (here / "design.toml").write_text(SHORT)
    return here / "design.toml"


def front_of(folder):
    return json.loads((folder / "front.json").read_text())


def files_of(folder):
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".npz" and path.name != OWN_FILES
    }


def analyzed(done, folder, member):
    """The words of the command of a member, and the SNR of Y that it gives. [dB]"""
    words = shlex.split(member["analyze"])
    words[words.index(member["sensor"])] = str(folder / member["sensor"])
    out, _ = done(*words[1:], "--json", "-")
    (sensor,) = json.loads(out)["sensors"]
    return words, sensor["color"]["snr_db"]["Y"]


def test_init_writes_a_design_and_the_command_that_searches_it(run, here):
    said = "design.toml: change it, then `chromanoise optimize design.toml`\n"
    assert run("init", "--design") == (0, said, "")
    assert (here / "design.toml").read_text() == DESIGN_STARTER
    refused(run("init", "--design"), "design.toml")


@pytest.fixture(scope="module")
def searched(tmp_path_factory):
    """A folder after a search, the folder of its results and what the command printed."""
    folder = tmp_path_factory.mktemp("search")
    (folder / "design.toml").write_text(SHORT)
    printed = io.StringIO()
    words = ("optimize", folder / "design.toml", *EFFORT, "-o", folder / "out" / "design")
    with redirect_stdout(printed), pytest.raises(SystemExit) as stop:
        main([str(word) for word in words])
    assert stop.value.code == 0
    return folder, folder / "out" / "design", printed.getvalue()


def test_each_member_is_a_sensor_file_that_analyze_takes_with_the_snr_of_the_front(done, searched):
    _, folder, _ = searched
    front = front_of(folder)
    assert {"front.csv", "front.svg", "front.json", "search.npz"} <= {
        path.name for path in folder.iterdir()
    }
    assert len(front["members"]) > 1
    for member in front["members"]:
        assert (folder / member["sensor"]).is_file()
    member = front["members"][0]
    _, snr_db = analyzed(done, folder, member)
    assert snr_db == pytest.approx(member["objectives"]["snr_y_db"], rel=1e-9)


def test_the_references_have_the_snr_that_analyze_gives_them(searched):
    references = front_of(searched[1])["references"]
    found = {one["name"]: one["objectives"]["snr_y_db"] for one in references}
    given = cn.analyze("onyx-rgbw", "onyx-rgb-ircut", matrix="lmmse", prior="chart")
    snrs = {name: snr["Y"] for name, snr in given.color_snr_db().items()}
    assert found == pytest.approx(snrs, rel=1e-9)


def test_members_are_sorted_from_the_best_of_the_first_objective_and_none_dominates(searched):
    values = [tuple(one["objectives"].values()) for one in front_of(searched[1])["members"]]
    assert values == sorted(values, reverse=True)  # a lower SNR must pay with a lower color error


SEVERAL = OF_CHART.replace("population = 200", "population = 8")  # seeds, and a polish


@pytest.mark.parametrize("text", [SHORT, pytest.param(SEVERAL, marks=pytest.mark.evidence)])
def test_a_stopped_search_continues_to_the_front_of_one_that_was_not(done, design, text):
    design.write_text(text)
    done("optimize", design, "--budget", "16", "-o", "out/a")
    done("optimize", design, *EFFORT, "-o", "out/a", "--resume")
    done("optimize", design, *EFFORT, "-o", "out/b")
    a, b = (files_of(design.parent / "out" / name) for name in "ab")
    a.pop("design.json"), b.pop("design.json")  # they record their own budgets
    assert a == b


def test_another_seed_gives_another_front(done, design, searched):
    done("optimize", design, *EFFORT, "--seed", 2, "-o", "other")
    assert front_of(design.parent / "other")["members"] != front_of(searched[1])["members"]


def test_the_function_gives_the_front_of_the_command_again(searched):
    folder, results, _ = searched
    front = cn.optimize(folder / "design.toml", budget=32)
    assert front.to_dict() == front_of(results)
    assert len(front.to_dataframe()) == len(front.members) + len(front.references)
    assert front.sensor(front.members[0].name).names == ("R", "G", "B")
    assert "\\begin{tabular}" in front.to_latex()
    assert front.plot().lines


def test_a_search_without_a_folder_for_its_checkpoint_cannot_continue(design):
    with pytest.raises(cn.InputError) as caught:
        cn.optimize(design, resume=True)
    assert caught.value.subject == "resume"


def test_a_folder_of_another_design_is_refused_before_the_search(run, design, searched):
    shutil.copytree(searched[1], design.parent / "mine")
    before = files_of(design.parent / "mine")
    design.write_text(SHORT.replace("width_nm = 8", "width_nm = 9"))
    refused(run("optimize", design, *EFFORT, "-o", "mine"), value="mine")
    assert files_of(design.parent / "mine") == before


def pipe(path):
    os.mkfifo(path)


def deep(path):
    path.write_text("[" * 100_000)


def surrogate(path):
    path.write_text('{"identity": "\\ud800"}')


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes in folders")
@pytest.mark.parametrize("made", [pipe, deep, surrogate])
def test_a_record_that_cannot_be_read_is_one_sentence_and_stays(run, design, made):
    folder = design.parent / "o"
    folder.mkdir()
    made(folder / "design.json")
    before = (folder / "design.json").lstat()
    refused(run("optimize", design, *EFFORT, "-o", folder), "another design")
    (file,) = folder.iterdir()
    after = file.lstat()  # its time of access may differ
    assert file.name == "design.json"
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pipes in folders")
def test_a_pipe_in_place_of_the_lock_is_not_waited_for(run, design):
    os.mkfifo(design.parent / ".o.chromanoise-lock")
    refused(run("optimize", design, *EFFORT, "-o", "o"), "o")


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        (("--resume", "-o", "none"), ["none", "search.npz"]),
        (("--budget", "3"), ["--budget", "3"]),
        (("--seed", "-1"), ["--seed", "-1"]),
        (("--scheduler", "nowhere"), ["nowhere"]),
        (("--json", "design.toml/front.json"), ["design.toml", "folder"]),
        (("--json", "."), ["--json", "folder"]),
    ],
)
def test_what_a_search_cannot_use_is_refused_and_leaves_no_folder(run, design, arguments, parts):
    refused(run("optimize", design, *arguments), *parts)
    assert [path.name for path in design.parent.iterdir()] == ["design.toml"]


def test_contradicting_constraints_are_one_sentence_that_names_them(run, design):
    limits = [("delta_e", "at_most = 0.01"), ("snr_y_db", "at_least = 60")]
    tables = [f'[[design.constraints]]\nobjective = "{o}"\n{limit}\n' for o, limit in limits]
    design.write_text(SHORT + "".join(tables))
    refused(run("optimize", design, *EFFORT), "delta_e <= 0.01", "snr_y_db >= 60")


def test_a_designed_exposure_and_matrix_are_those_of_the_command_of_a_member(done, design):
    numbers = "[design.exposure]\ntime_ms = [2, 8]\n[design.matrix]\nnoise_weight = [0.1, 1]\n"
    design.write_text(SHORT + numbers)
    done("optimize", design, *EFFORT, "-o", "out")
    for member in front_of(design.parent / "out")["members"][:2]:
        words, snr_db = analyzed(done, design.parent / "out", member)
        assert float(words[words.index("--time-ms") + 1]) == pytest.approx(
            member["values"]["exposure.time_ms"]
        )
        assert snr_db == pytest.approx(member["objectives"]["snr_y_db"], rel=1e-9)


def test_the_printed_tables_fit_100_characters_with_many_objectives(done, design):
    many = '["snr_y_db", "delta_e", "vora", "noise_delta_e", "mean_separation"]'
    design.write_text(SHORT.replace('["snr_y_db", "delta_e"]', many))
    out, _ = done("optimize", design, "--budget", "8")
    assert max(len(line) for line in out.splitlines() if line[:1] in "┃│┏┡└") == 100


def test_the_printed_tables_have_all_parameters_extremes_and_references(searched):
    _, folder, out = searched
    tables = [line for line in out.splitlines() if line[:1] in "┃│┏┡└"]
    members = front_of(folder)["members"]
    for name in members[0]["values"]:
        assert sum(f"│ {name} [nm] " in line for line in tables) == 1
    marked = [one["name"] for one in members if one["extreme_of"] or one["knee"]]
    assert "best-delta_e" in marked
    for name in ("onyx-rgbw", "onyx-rgb-ircut", *marked):
        assert sum(line.startswith((f"│ {name} ", f"┃ {name} ")) for line in tables) == 1
