"""Results can be rerun from any folder, changed inputs are detected, agreement is measured."""

import json
import os
import platform
import re
import shutil
import tempfile
from pathlib import Path

import numpy as np
import pytest
import tifffile

from chromanoise.base.errors import InputError
from chromanoise.base.files import OWN_FILES
from chromanoise.base.inputs import content_hash
from chromanoise.study import agreement_of, agreement_text, read_study, run_study
from outcomes import refused, refused_input
from processes import printed

STUDY = """\
matrices = ["kernel"]
[light]
illuminant = "lamp.csv"
[[sensors]]
name = "cam.csv"
[[pictures]]
cube = "cube.npz"
formats = ["png", "xyz"]
"""
WAVELENGTH = np.linspace(400, 1050, 14)


def cube_of(reflectance):
    return {
        "reflectance": np.full((8, 8, WAVELENGTH.size), reflectance, np.float32),
        "wavelength_nm": WAVELENGTH,
    }


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A folder with a study and the files of its sensor, light and cube."""
    folder = tmp_path / "project"
    folder.mkdir()
    rows = [f"{w},{0.3},{0.1 + w / 9000},{0.2}" for w in range(400, 1051, 10)]
    (folder / "cam.csv").write_text("\n".join(["wavelength_nm,A,B,C", *rows]))
    (folder / "lamp.csv").write_text("wavelength_nm,lamp [W]\n380,1\n1060,2\n")
    np.savez(folder / "cube.npz", **cube_of(0.5))
    (folder / "study.toml").write_text(STUDY)
    monkeypatch.chdir(folder)
    return folder


def files_of(folder):
    """The outputs; of the record, all but the way to the project, which depends on the folder."""
    found = {path.name: path.read_bytes() for path in folder.iterdir() if path.name != OWN_FILES}
    record = json.loads(found["study.json"])
    place = record.pop("place")
    record.pop("content")
    assert not Path(place).is_absolute()
    return found | {"study.json": record}


@pytest.fixture
def made(done, project):
    done("run", "study.toml")
    return project / "out" / "study"


def test_a_result_runs_again_from_any_folder_to_the_same_bytes(
    run, done, made, tmp_path, monkeypatch
):
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for number, output in enumerate((made, made / "analysis-kernel.json")):
        out, err = done("rerun", output, "-o", f"again-{number}")
        assert out.split() == [
            f"again-{number}/{name}.json" for name in ("analysis-kernel", "pictures-1")
        ]
        assert files_of(Path(f"again-{number}")) == files_of(made)
        assert "same results" in err.splitlines()[-1]
    assert Path.cwd() == tmp_path / "elsewhere"
    monkeypatch.chdir(made.parent.parent)
    assert "same bytes" in run("rerun", made, "-o", "out/again")[2].splitlines()[-1]


def test_results_outside_of_the_project_find_its_files(run, project, tmp_path, monkeypatch):
    assert run("run", "study.toml", "-o", tmp_path / "results")[0] == 0
    monkeypatch.chdir(tmp_path)
    assert run("rerun", "results", "-o", "again")[0] == 0
    assert files_of(tmp_path / "again") == files_of(tmp_path / "results")


def test_a_project_that_was_moved_is_rerun_with_its_own_files(done, made, project, tmp_path):
    os.chdir(tmp_path)
    project.rename(tmp_path / "moved")
    project.mkdir()
    (project / "cam.csv").write_text("another file in the old place")
    _, err = done("rerun", "moved/out/study", "-o", "again")
    for name in ("analysis-kernel.json", "pictures-1.json"):
        assert (Path("again") / name).read_bytes() == (Path("moved/out/study") / name).read_bytes()
    assert "same results" in err.splitlines()[-1]


def with_place(folder, place):
    """Write the record of a run as it would be with another path to the files of its study."""
    file = folder / "study.json"
    record = json.loads(file.read_bytes()) | {"place": str(place)}
    file.write_text(json.dumps(record | {"content": content_hash(record)}, indent=1) + "\n")


@pytest.mark.parametrize("gone", [False, True])
def test_a_record_with_the_whole_path_of_the_project_is_rerun(done, made, project, tmp_path, gone):
    with_place(made, tmp_path / "no such folder" if gone else project)
    os.chdir(tmp_path)
    shutil.move(made, project / "o" if gone else tmp_path / "o")
    _, err = done("rerun", project / "o" if gone else "o", "-o", "again")
    assert ("no such folder" in err.splitlines()[-1]) == gone


def test_no_output_names_the_folders_above_the_project(run, made, project, tmp_path):
    for path in made.rglob("*"):
        assert str(tmp_path).encode() not in path.read_bytes(), path
    assert json.loads((made / "study.json").read_bytes())["place"] == "../.."
    far = Path("/var/tmp" if str(tmp_path).startswith("/tmp/") else "/tmp")
    with tempfile.TemporaryDirectory(dir=far) as folder:
        assert run("run", "study.toml", "-o", Path(folder) / "o")[0] == 0
        assert "place" not in json.loads((Path(folder) / "o/study.json").read_bytes())
        assert run("rerun", Path(folder) / "o", "-o", "again")[0] == 0  # from the project


@pytest.mark.evidence
@pytest.mark.parametrize("name", ["study.json", "analysis-kernel.json", "pictures-1.json"])
@pytest.mark.parametrize(
    "content",
    [
        "{}",
        "[]",
        "null",
        "1e400",
        "[" * 50_000,
        '{"a":' * 500 + "1" + "}" * 500,
        '"\\ud800"',
        "pipe",
    ],
    ids=lambda text: text[:9],
)
def test_an_output_with_other_content_is_one_sentence_or_a_difference(
    run, made, tmp_path, name, content
):
    (made / name).unlink()
    if content == "pipe":
        os.mkfifo(made / name)
    else:
        (made / name).write_text(content)
    refused(run("rerun", made / name, "-o", tmp_path / "a"), name)
    if name == "study.json":
        refused(run("rerun", made, "-o", tmp_path / "b"), name)
        return
    code, _, err = run("rerun", made, "-o", tmp_path / "b")
    last = err.splitlines()[-1]
    assert (code, name in last, "libraries" in last) == (1, True, False), err


@pytest.mark.parametrize("name", ["catalog", "catalog:"])
def test_a_folder_of_the_project_named_catalog_is_found_from_elsewhere(
    done, project, tmp_path, monkeypatch, name
):
    (project / name).mkdir()
    (project / "cam.csv").rename(project / name / "cam.csv")
    (project / "study.toml").write_text(
        f'matrices = ["kernel"]\n[[sensors]]\nname = "{name}/cam.csv"\n'
    )
    done("run", "study.toml", "-o", "results")
    monkeypatch.chdir(tmp_path)
    done("rerun", project / "results", "-o", "again")
    assert files_of(tmp_path / "again") == files_of(project / "results")


def test_a_project_whose_files_are_missing_is_refused_in_one_sentence(run, made, project, tmp_path):
    os.chdir(tmp_path)
    made.rename(tmp_path / "results")
    project.rename(tmp_path / "gone")
    refused(run("rerun", "results", "-o", "again"), "results/study.json", "cam.csv")
    assert not (tmp_path / "again").exists()


def changed_in_place(path):
    np.savez(path, **cube_of(0.25))


def grown(path):
    path.write_bytes(path.read_bytes() + b"more")


@pytest.mark.parametrize("change", [changed_in_place, grown, Path.unlink])
def test_a_cube_that_changes_while_it_is_read_gives_no_result(project, change):
    def reported(what, _):
        if "cube" in what:  # after its digest was taken, before it is read
            change(project / "cube.npz")

    with pytest.raises(InputError, match=r"cube\.npz") as error:
        run_study(read_study("study.toml"), Path("o"), report=reported)
    assert len(str(error.value).splitlines()) == 1
    assert not Path("o").exists()


def test_a_file_with_another_date_and_the_same_content_is_the_same_file(project):
    study = read_study("study.toml")
    run_study(study, Path("o"), report=lambda *_: os.utime(project / "cube.npz", (100, 100)))
    assert run_study(study, Path("o")) == [
        Path("o/analysis-kernel.json"),
        Path("o/pictures-1.json"),
    ]


@pytest.mark.parametrize(
    ("key", "value"),
    [("seed", 8), ("version", "9.9"), ("steps", []), ("place", "/"), ("numerics", {})],
)
def test_every_change_of_the_record_of_a_run_is_detected(run, made, key, value):
    record = json.loads((made / "study.json").read_bytes())
    assert record[key] != value
    (made / "study.json").write_text(json.dumps(record | {key: value}, indent=1) + "\n")
    refused(run("rerun", made, "-o", "again"), "study.json", "changed since")
    code, _, err = run("run", "study.toml")
    assert (code, len(err.splitlines())) == (2, 1)
    assert not Path("again").exists()


def test_a_run_into_a_folder_that_another_run_is_writing_is_refused(project):
    def reported(*_):
        run_study(read_study("study.toml"), Path("o"))

    with refused_input(subject="o", value=os.getpid()):
        run_study(read_study("study.toml"), Path("o"), report=reported)


def test_agreement_names_the_largest_relative_difference_and_its_place(made, tmp_path):
    same = agreement_of(made, made)
    assert (same.files, same.other_bytes, same.largest) == (len(files_of(made)), (), 0.0)
    shutil.copytree(made, tmp_path / "again")
    file = tmp_path / "again" / "analysis-kernel.json"
    data = json.loads(file.read_bytes())
    own = data["result"]["sensors"][0]
    (stage,) = [key for key, value in own.items() if isinstance(value, float)][:1]
    own[stage] *= 1 + 2e-6
    file.write_text(json.dumps(data))
    found = agreement_of(made, tmp_path / "again")
    assert found.other_bytes == ("analysis-kernel.json",)
    assert found.where == f"analysis-kernel.json /sensors/0/{stage}"
    assert found.largest == pytest.approx(2e-6, rel=1e-5)
    assert not found.incomparable
    (picture,) = (tmp_path / "again").glob("*.xyz.tiff")
    xyz = tifffile.imread(picture)
    xyz[3, 4, 1] *= 1.5
    tifffile.imwrite(picture, xyz, photometric="minisblack", planarconfig="contig")
    found = agreement_of(made, tmp_path / "again")
    assert found.where == picture.name
    assert found.largest == pytest.approx(1 / 3, rel=1e-5)
    (made / "pictures-1.json").unlink()
    assert agreement_of(made, tmp_path / "again").incomparable == ("pictures-1.json",)
    assert re.search(r"3\.3e-01", agreement_text(found))


def test_only_another_place_or_machine_in_the_record_is_no_difference_of_results(made, tmp_path):
    shutil.copytree(made, tmp_path / "again")
    file = made / "study.json"
    data = json.loads(file.read_bytes())
    data["numerics"]["machine"] = "riscv128"
    data["place"] = "/far/away"
    file.write_text(json.dumps(data))
    found = agreement_of(made, tmp_path / "again")
    assert (found.other_bytes, found.incomparable, found.where) == ((), (), "")
    assert found.place == "/far/away"
    assert found.numerics == ("machine",)
    text = agreement_text(found)
    assert "/far/away" in text
    assert "machine" in text
    assert "same bytes" not in text
    data["seed"] = 99
    file.write_text(json.dumps(data))
    assert agreement_of(made, tmp_path / "again").other_bytes == ("study.json",)


def record_of(folder, **variables):
    script = "from chromanoise.study.hashes import numerics; print(repr(numerics()))"
    return eval(printed(script, cwd=folder, **variables))


def test_the_record_names_what_determines_the_last_digits(made, tmp_path):
    record = json.loads((made / "study.json").read_bytes())["numerics"]
    assert (record["machine"], record["numpy"]) == (platform.machine(), np.__version__)
    if record["blas_kernel"] is None or platform.machine() != "x86_64":
        pytest.skip("the BLAS of this numpy does not report its kernel")
    assert record_of(tmp_path, OPENBLAS_CORETYPE="Nehalem")["blas_kernel"] == "Nehalem"


def test_a_result_with_another_number_is_reported_with_exit_code_1(run, made):
    path = made / "analysis-kernel.json"
    record = json.loads(path.read_text())
    sensor = record["result"]["sensors"][0]
    sensor["bound_db"] *= 1.001
    path.write_text(json.dumps(record))
    code, _, err = run("rerun", made / "study.json", "-o", "again")
    assert (code, "bound_db" in err.splitlines()[-1]) == (1, True)
