"""No command loses a file that it did not write, in a folder that it fills: a law for all commands.

Every option that names a path has an entry here, so that a new command cannot be forgotten.
"""

import json
import os
import signal
import stat
import time
from pathlib import Path

import click
import numpy as np
import pytest

import chromanoise as cn
from chromanoise.apps.design import DESIGN_STARTER
from chromanoise.base.files import OWN_FILES
from chromanoise.cli import entry
from outcomes import refused_input
from processes import command, wait_for

STUDY = """\
matrices = ["kernel"]
[[sensors]]
name = "model-rgb"
[[pictures]]
cube = "cube.npz"
formats = ["png", "xyz"]
"""
BUDGET = 16
OF_CHART = DESIGN_STARTER.replace('["kernel"]', '["lmmse"]\nprior = "chart"')  # few reflectances
DESIGN = OF_CHART.replace("population = 200", "population = 8\nseeds = 1\npolish = false")
CROP = ("--sensor", "onyx-rgbw", "--levels", 10, "--crop", 32, "--denoise", "none")
DUMP = ("--mosaic", "RG/GB", "--black-level", 100, "--gain-dn-per-e", 0.5, "--read-noise-e", 5)
FILLS = {  # option of a folder: the words before it, and those with which a stopped run goes on
    ("simulate", "out"): (("cube.npz", "--sensor", "model-rgb", "--time-ms", 12, "-o"), ()),
    ("denoise", "out"): (("flat.npy", *DUMP, "--bits", 12, "--denoise", "lmmse", "-o"), ()),
    ("optimize", "out"): (("design.toml", "--budget", BUDGET, "-o"), ("--resume",)),
    ("run", "out"): (("study.toml", "-o"), ()),
    ("rerun", "out"): (("made", "-o"), ()),
    ("characterize", "out"): (("frames", "-o"), ()),
    ("denoise-bench", "out"): (("builtin:slanted-edges", *CROP, "-o"), ()),
    ("demo-frames", "out"): (("--shape", "20x24", "--levels", 3, "-o"), ()),
    ("report", "figures"): (("study.toml", "-o", "report-of-the-test.html", "--figures"), ()),
    ("reproduce", "out"): (("--draws", 50, "-o"), ()),
    ("demo", "out"): (("-o",), ()),
}
SLOW = {"characterize", "denoise-bench", "report", "reproduce", "demo"}  # they draw many charts
WRITES_A_FILE = {
    ("report", "out"),
    ("card", "out"),
    ("characterize", "resume"),
}  # named by the user
READS = {("catalog", "folder"), ("serve", "front")}
NEEDS_AN_EMPTY_FOLDER = {"demo-frames"}
MADE = {}  # what each command has made once
KINDS = ("a file", "a link", "a folder", "a dangling link")
KEPT = {"search.npz", OWN_FILES}
"""What a failed search may leave: its checkpoint, and the list that shows who wrote it."""

pytestmark = pytest.mark.usefixtures("project")


def path_options():
    context = click.Context(entry.commands)
    return {
        (name, option.name)
        for name in entry.commands.list_commands(context)
        for option in entry.commands.get_command(context, name).params
        if isinstance(option, click.Option) and isinstance(option.type, click.Path)
    }


def cases(*, without=()):
    return [
        pytest.param(*which, id="-".join(which), marks=[pytest.mark.evidence] * (which[0] in SLOW))
        for which in FILLS
        if which[0] not in without
    ]


@pytest.fixture
def project(here):
    """A working folder with the inputs of all commands."""
    rng = np.random.default_rng(1)
    reflectance = rng.random((12, 12, 14), np.float32)
    np.savez("cube.npz", reflectance=reflectance, wavelength_nm=np.linspace(400, 1050, 14))
    np.save("flat.npy", np.clip(rng.normal(500, 20, (32, 32)), 0, 4095).astype(np.uint16))
    Path("study.toml").write_text(STUDY)
    Path("design.toml").write_text(DESIGN)


@pytest.fixture
def ended(run):
    """Run a command into a folder; give back its exit code and what it says."""

    def call(name, option, folder, *more):
        if name == "rerun" and not Path("made").exists():
            assert run("run", "study.toml", "-o", "made")[0] == 0
        if name == "characterize" and not Path("frames").exists():
            words = ("--mosaic", "RG/GB", "--levels", 8, "--shape", "32x40", "-o", "frames")
            assert run("demo-frames", *words)[0] == 0
        code, _, err = run(name, *FILLS[name, option][0], folder, *more)
        return code, err

    return call


@pytest.fixture
def made_by(ended):
    """The names of the files that a command makes."""

    def names(name, option):
        if (name, option) not in MADE:
            code, err = ended(name, option, "plain")
            assert code == 0, err
            MADE[name, option] = outputs("plain")
        return MADE[name, option]

    return names


def state(folder):
    """All that a folder holds: kind, mode and content by name."""
    found = {}
    for path in Path(folder).rglob("*"):
        facts = path.lstat()
        kept = path.readlink() if path.is_symlink() else ""
        if stat.S_ISREG(facts.st_mode):
            kept = path.read_bytes()
        found[str(path.relative_to(folder))] = (stat.filemode(facts.st_mode), kept)
    return found


def of_others(names):
    """Files not written by a run, with names like those of the outputs, in all other places."""
    plain = ["notes.txt", ".hidden", "a b.json", "sensors/mycamera.json", "sensors/front-01.txt"]
    plain += ["member-01.json", "knee.json", "sensors/.knee.json", f"deep/{OWN_FILES}", "deep/er/x"]
    records = {
        "study.json",
        "summary.json",
        "front.json",
        "design.json",
        "search.npz",
        "index.html",
    }
    spare = [f"{name}{end}" for name in sorted(names) for end in ("~", ".bak")]
    deeper = [f"old/{name}" for name in sorted({*names, *records})]
    beside = [f".{name}-0123abcd" for name in sorted(names) if "/" not in name]
    return [*plain, *spare, *deeper, *beside]


def filled(folder, names):
    for i, name in enumerate(names):
        path = Path(folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"not written by a run: {name}")
        path.chmod((0o600, 0o644, 0o444, 0o750)[i % 4])
    (Path(folder) / "empty").mkdir()
    return state(folder)


def outputs(folder):
    return {name for name, one in state(folder).items() if one[0][0] == "-" and name != OWN_FILES}


def test_every_option_that_names_a_path_has_its_entry():
    assert path_options() == FILLS.keys() | WRITES_A_FILE | READS


@pytest.mark.evidence
@pytest.mark.parametrize(("name", "option"), cases(without=NEEDS_AN_EMPTY_FOLDER))
def test_foreign_files_stay_through_a_first_a_second_and_a_resumed_run(
    ended, made_by, name, option
):
    made = made_by(name, option)
    before = filled("o", of_others(made))
    resumed = [(option,) for option in FILLS[name, option][1]]
    for more in ((), (), *resumed):
        code, err = ended(name, option, "o", *more)
        assert code == 0, err
        after = state("o")
        assert {key: after.get(key) for key in before} == before
        assert outputs("o") == {key for key in before if before[key][0][0] == "-"} | made
    assert not list(Path().glob(".o*"))


@pytest.mark.parametrize("name", sorted(NEEDS_AN_EMPTY_FOLDER))
def test_a_folder_that_must_be_empty_is_refused_as_it_is(ended, name):
    before = filled("o", ["notes.txt", ".hidden"])
    assert ended(name, "out", "o")[0] == 2
    assert state("o") == before


def taken(path, kind):
    path.parent.mkdir(parents=True, exist_ok=True)
    if kind == "a file":
        path.write_text("not written by a run")
        path.chmod(0o600)
    elif kind == "a folder":
        path.mkdir()
        (path / "mine.txt").write_text("not written by a run")
    else:
        path.symlink_to("../elsewhere.txt" if kind == "a link" else "../nowhere")


@pytest.mark.parametrize(("name", "option"), cases())
def test_a_name_that_is_taken_is_refused_and_nothing_changes(ended, made_by, name, option):
    names = sorted(made_by(name, option))
    Path("elsewhere.txt").write_text("not written by a run")
    for number, kind in enumerate(KINDS):
        one = [*names, OWN_FILES][number * len(names) // (len(KINDS) - 1)]
        folder = Path(f"o{number}")
        taken(folder / one, kind)
        (folder / "notes.txt").write_text("not written by a run")
        before = state(folder)
        code, err = ended(name, option, folder)
        after = state(folder)
        if name == "optimize" and one not in KEPT:
            after = {key: value for key, value in after.items() if key not in KEPT}
        assert after == before, one
        assert (code, len(err.splitlines()[-1:])) == (2, 1), one
        assert Path("elsewhere.txt").read_text() == "not written by a run"
        assert not list(Path().glob(f".{folder}*"))


@pytest.mark.parametrize(("name", "option"), cases(without=NEEDS_AN_EMPTY_FOLDER))
def test_a_changed_output_is_never_lost(ended, name, option):
    assert ended(name, option, "o")[0] == 0
    names = sorted(outputs("o"))
    for one in (names[0], names[-1]):
        path = Path("o") / one
        whole = path.read_bytes()
        path.write_bytes(whole + b" changed")
        before = state("o")
        code, _ = ended(name, option, "o")
        after = state("o")
        assert after[one] == before[one]
        assert code == 2, one
        assert {key: after[key] for key in before} == before
        path.write_bytes(whole)


def test_a_member_of_an_earlier_front_goes_only_if_nobody_changed_it(ended):
    assert ended("optimize", "out", "o")[0] == 0
    listed = Path("o") / OWN_FILES
    record = json.loads(listed.read_text())
    first = next(name for name in record["files"] if name.startswith("sensors/"))
    known, member = record["files"][first], (Path("o") / first).read_bytes()
    for old in ("sensors/member-98.json", "sensors/member-99.json"):
        (Path("o") / old).write_bytes(member)
        record["files"][old] = known
    listed.write_text(json.dumps(record))
    (Path("o") / "sensors/member-97.json").write_bytes(member)  # only its content is ours
    code, err = ended("optimize", "out", "o")
    assert code == 2
    assert "member-97" in err
    (Path("o") / "sensors/member-97.json").rename("o/sensors/mine.json")
    assert ended("optimize", "out", "o")[0] == 0
    assert not (Path("o") / "sensors/member-98.json").exists()
    assert (Path("o") / "sensors/mine.json").read_bytes() == member


def test_a_search_of_which_only_record_and_checkpoint_were_copied_is_resumed(ended):
    assert ended("optimize", "out", "o")[0] == 0
    Path("copy").mkdir()
    for name in ("design.json", "search.npz"):
        (Path("copy") / name).write_bytes((Path("o") / name).read_bytes())
    code, err = ended("optimize", "out", "copy")
    assert (code, "search.npz" in err) == (2, True)
    code, err = ended("optimize", "out", "copy", "--resume")
    assert code == 0, err
    assert (Path("copy") / "front.csv").read_bytes() == (Path("o") / "front.csv").read_bytes()


@pytest.mark.evidence
def test_the_default_report_replaces_no_file_that_the_user_did_not_name(run):
    Path("report.html").write_text("not written by a run")
    before = state(".")
    assert run("report", "study.toml")[0] == 2
    assert state(".") == before
    Path("report.html").rename("mine.html")
    for figures in ((), ("--figures", ".")):  # into the folder of the report
        assert run("report", "study.toml", *figures)[0] == 0
    page = Path("report.html").read_bytes()
    Path("report.html").write_bytes(page + b"mine")
    assert run("report", "study.toml")[0] == 2
    assert Path("report.html").read_bytes() == page + b"mine"
    assert run("report", "study.toml", "-o", "report.html")[0] == 0
    assert Path("report.html").read_bytes() == page


def test_a_command_leaves_the_outputs_of_another_one(ended):
    assert ended("demo-frames", "out", "o")[0] == 0
    Path("o/truth.toml").rename("o/model-rgb.png")
    listed = json.loads((Path("o") / OWN_FILES).read_text())
    listed["files"]["model-rgb.png"] = listed["files"].pop("truth.toml")
    (Path("o") / OWN_FILES).write_text(json.dumps(listed))
    before = state("o")
    code, err = ended("simulate", "out", "o")
    assert (code, "model-rgb.png" in err) == (2, True)
    assert state("o") == before


def test_a_lock_file_of_another_program_is_refused_and_stays(ended):
    lock = Path(".o.chromanoise-lock")
    for number, kind in enumerate((*KINDS, "a pipe")):
        taken(lock, kind) if kind in KINDS else os.mkfifo(lock)
        before = state(".")
        assert ended("demo-frames", "out", "o")[0] == 2, kind
        assert state(".") == before
        lock.rename(f"lock-{number}")
    Path("o").mkdir()
    taken(Path("o/.o.chromanoise-lock"), "a file")  # where a lock is if the folder cannot be moved
    Path("o/notes.txt").write_text("mine")
    before = state("o")
    code, err = ended("simulate", "out", "o")
    assert code == 0, err
    assert {key: one for key, one in state("o").items() if key in before} == before


@pytest.mark.parametrize(
    ("name", "sent", "wait_s"),
    [("optimize", signal.SIGKILL, 0.3)]
    + [
        pytest.param(name, sent, part * seconds, marks=pytest.mark.evidence)
        for name, seconds in {"optimize": 4.0, "run": 2.0, "simulate": 1.0}.items()
        for sent in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
        for part in (0.0, 0.3, 0.8)
    ],
)
def test_foreign_files_stay_when_a_run_is_killed_and_goes_on(run, made_by, name, sent, wait_s):
    before = filled("o", of_others(made_by(name, "out")))
    words, resume = FILLS[name, "out"]
    words = [2000 if word == BUDGET else word for word in words]
    with command(name, *words, "o") as process:
        wait_for(lambda: process.poll() is not None or list(Path().glob(".o.*")), process)
        if name == "optimize":
            wait_for(Path("o/search.npz").exists, process)
        time.sleep(wait_s)
        process.send_signal(sent)
        process.wait(timeout=60)
    after = state("o")
    assert {key: after.get(key) for key in before} == before
    code, _, err = run(name, *words, "o", *resume)
    assert code == 0, err
    after = state("o")
    assert {key: after.get(key) for key in before} == before
    assert not list(Path().glob(".o*"))


REFUSED = {  # the second step of each is refused, after the first has been computed
    "no reflectance": ('cube = "cube.npz"', 'cube = "wrong.npz"'),
    "no such file": ('cube = "cube.npz"', 'cube = "none.npz"'),
}


@pytest.mark.parametrize("old", [{}, {"notes.txt": "mine"}], ids=["new", "with notes"])
@pytest.mark.parametrize("fault", REFUSED)
def test_a_run_that_is_refused_leaves_its_folder_as_it_was_and_the_corrected_study_runs(
    run, fault, old
):
    wrong = np.random.default_rng(1).random((12, 12, 14), np.float32)
    wrong[3, 3, 3] = np.nan
    np.savez("wrong.npz", reflectance=wrong, wavelength_nm=np.linspace(400, 1050, 14))
    Path("wrong.toml").write_text(STUDY.replace(*REFUSED[fault]))
    for name, text in old.items():
        Path("o").mkdir(exist_ok=True)
        (Path("o") / name).write_text(text)
    before = state(".")
    assert run("run", "wrong.toml", "-o", "o")[0] == 2
    assert state(".") == before
    assert run("run", "study.toml", "-o", "o")[0] == 0
    assert {name: (Path("o") / name).read_text() for name in old} == old


def test_a_run_that_a_full_disk_ends_keeps_the_results_that_are_complete(run, monkeypatch):
    from chromanoise.study import running

    real = running.run_plan

    def planned(*words, **more):
        plan = real(*words, **more)

        def full(folder, advance):
            raise OSError(28, "No space left on device")

        object.__setattr__(plan.steps[-1], "run", full)
        return plan

    with monkeypatch.context() as full:
        full.setattr("chromanoise.study.run_files.run_plan", planned)
        assert run("run", "study.toml", "-o", "o")[0] == 2
    assert outputs("o") == {"study.json", "analysis-kernel.json"}
    code, _, err = run("run", "study.toml", "-o", "o")
    assert code == 0, err


def test_a_search_without_a_result_leaves_its_checkpoint_and_a_corrected_design_runs(run):
    text = DESIGN.replace("population = 8", "population = 8\nbudget = 32", 1)
    impossible = Path("design.toml").read_text().split("[[design.constraints]]")
    Path("design.toml").write_text(
        impossible[0] + '[[design.constraints]]\nobjective = "delta_e"\nat_most = 1e-9\n'
    )
    assert "population = 8" in text
    Path("o").mkdir()
    Path("o/notes.txt").write_text("mine")
    before = state("o")
    code, _, err = run("optimize", "design.toml", "--budget", 32, "-o", "o")
    assert code == 2, err
    after = state("o")
    assert {key: after[key] for key in before} == before
    assert after.keys() - before.keys() <= KEPT
    Path("design.toml").write_text(DESIGN)
    code, _, err = run("optimize", "design.toml", "--budget", 32, "-o", "o")
    assert code == 0, err
    assert Path("o/notes.txt").read_text() == "mine"


def test_a_picture_of_python_replaces_only_pictures_of_python():
    Path("o").mkdir()
    before = filled("o", ["notes.txt", "sub/picture-1-model-rgb-kernel.png"])
    for _ in range(2):
        cn.render("cube.npz", "model-rgb", time_ms=12, folder="o")
    after = state("o")
    assert {key: after[key] for key in before} == before
    (picture,) = Path("o").glob("*.png")
    picture.write_bytes(b"mine")
    before = state("o")
    with refused_input(subject=str(picture), found="was changed after it was written"):
        cn.render("cube.npz", "model-rgb", time_ms=12, folder="o")
    assert state("o") == before


# ---- modes ----


def mode_of(path):
    return stat.S_IMODE(Path(path).stat().st_mode)


@pytest.fixture(params=[0o022, 0o077, 0o002], ids=lambda mask: f"umask {mask:03o}")
def umask(request):
    before = os.umask(request.param)
    yield request.param
    os.umask(before)


def test_new_files_and_folders_have_the_mode_that_the_umask_leaves(run, umask):
    assert run("run", "study.toml", "-o", "new/o")[0] == 0
    assert run("analyze", "onyx-rgb", "--json", "a.json", "--table", "a.csv")[0] == 0
    for path in (Path("a.json"), Path("a.csv"), Path("new"), *Path("new").rglob("*")):
        assert mode_of(path) == (0o777 if path.is_dir() else 0o666) & ~umask, path


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_a_file_that_is_replaced_keeps_its_mode(run, mode):
    Path("a.json").write_text("{}")
    Path("a.json").chmod(mode)
    assert run("analyze", "onyx-rgb", "--json", "a.json")[0] == 0
    assert mode_of("a.json") == mode
    for _ in range(2):
        assert run("simulate", *FILLS["simulate", "out"][0], "o")[0] == 0
        files = [path for path in Path("o").rglob("*") if path.is_file()]
        assert len(files) > 2
        for path in files:
            path.chmod(mode)
    assert run("simulate", *FILLS["simulate", "out"][0], "o")[0] == 0
    assert {mode_of(path) for path in Path("o").rglob("*") if path.is_file()} == {mode}
