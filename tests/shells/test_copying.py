"""``--copy-as``: what it prints computes the digits of the command that printed it."""

import json
import runpy
import shlex
import subprocess
import sys

import numpy as np
import pytest
import tifffile

from chromanoise.study import study_as_command, study_from_data, study_from_text
from outcomes import refused

GIVEN = ("--lux", 3, "--f-number", 2.8, "--metric", "energy")


@pytest.fixture
def copied(run, done, tmp_path):
    """Run a command with --copy-as toml, run that study; give back its results by step."""

    def call(*arguments):
        code, out, err = run(*arguments, "--copy-as", "toml")
        assert (code, err) == (0, "")
        path = tmp_path / "copied.toml"
        path.write_text(out)
        done("run", path, "-o", tmp_path / "copied")
        found = {p.stem: json.loads(p.read_bytes()) for p in (tmp_path / "copied").glob("*.json")}
        return {name: result["result"] for name, result in found.items() if "result" in result}

    return call


@pytest.fixture
def curves(tmp_path):
    path = tmp_path / "my cam.csv"
    rows = [f"{w},{30 + w % 50},{20 + w % 70},{w / 20}" for w in range(400, 1001, 20)]
    path.write_text("\n".join(["wavelength_nm,R,G,B", *rows]))
    return path


@pytest.fixture
def sheet(tmp_path):
    path = tmp_path / "sheet.txt"
    path.write_text("K = 0.5 DN/e-\nsigma_d = 3.0 e-\nmu_e.sat = 8000 e-\nPRNU = 1 %\n")
    return path


@pytest.mark.parametrize(
    "options",
    [
        ("--clip", "--prnu", 0.02, "--dsnu-e", 5, "--format", "png,xyz,srgb16"),
        ("--mosaic", "sensor", "--demosaic", "lmmse", "--bits", 10, "--black-level", 32),
        ("--mosaic", "bayer", "--raw-only", "--frames", 2, "--seed", 5, "--row-noise-e", 3),
    ],
)
def test_a_study_copied_from_simulate_gives_its_pictures(done, copied, options, tmp_path):
    asked = ("simulate", "builtin:checker", "--sensor", "model-rgb", *options)
    ours = copied(*asked)["pictures-1"]["pictures"]
    done(*asked, "-o", tmp_path / "o")
    theirs = json.loads((tmp_path / "o" / "summary.json").read_text())["pictures"]
    for mine, other in zip(ours, theirs, strict=True):
        for name, same in zip(mine.pop("files"), other.pop("files"), strict=True):
            pair = (tmp_path / "copied" / name, tmp_path / "o" / same)
            assert pair[0].read_bytes() == pair[1].read_bytes()
        assert mine == {key: value for key, value in other.items() if key != "seconds"}


def test_how_a_cube_is_to_be_read_is_copied(run, copied, tmp_path):
    path = tmp_path / "cube.npz"
    np.savez(path, mine=np.linspace(0.1, 0.9, 6 * 14).reshape(6, 14))
    asked = (
        *("simulate", path, "--sensor", "model-rgb", "--key", "mine", "--shape", "2x3"),
        *("--wavelengths", "400:1050", "--scale", 0.5),
    )
    copied(*asked)
    assert run(*asked, "-o", tmp_path / "o")[0] == 0
    (ours,) = (tmp_path / "copied").glob("*.xyz.tiff")
    theirs = tmp_path / "o" / "model-rgb.xyz.tiff"
    assert (tifffile.imread(ours) == tifffile.imread(theirs)).all()


def test_a_copied_script_runs_by_itself_and_prints_the_digits(done, tmp_path, result_of):
    options = ("onyx-rgbw", "--lux", 2, "--budget")
    out, _ = done("analyze", *options, "--copy-as", "python")
    (tmp_path / "s.py").write_text(out)
    script = subprocess.run(
        [sys.executable, "s.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert json.loads(script.stdout) == [result_of("analyze", *options)]


@pytest.mark.parametrize(
    "options",
    [
        ("analyze", "onyx-rgbw", "--json", "x.json"),
        ("analyze", "onyx-rgbw", "--table", "x.csv"),
        ("compare", "onyx-rgbw", "--json", "-"),
        ("matrix", "onyx-rgbw", "--export", "x.csv"),
        ("simulate", "builtin:checker", "--sensor", "onyx-rgbw", "--threads", 2),
        ("simulate", "builtin:checker", "--sensor", "onyx-rgbw", "--out", "o"),
    ],
)
def test_what_a_study_cannot_say_is_refused_by_name(run, options, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    refused(run(*options, "--copy-as", "toml"), subject=options[-2], value=str(options[-1]))
    assert not list(tmp_path.iterdir())


COMMANDS = [
    "chromanoise analyze onyx-rgbw --lux 3.0 --budget",
    "chromanoise analyze onyx-rgbw './-x $(y).csv' --time-ms 4.0 --percent --photons --clip "
    "--chart --space lab",
    "chromanoise compare onyx-rgbw model-rgb --sweep lux=0.1:10.0 --equal light --points 5",
    "chromanoise compare onyx-rgbw --sweep kelvin=2000.0:9000.0 --prior all --matrix lmmse",
    "chromanoise matrix onyx-rgbw --pareto 0.1:10.0:3 --matrix ridge=0.1",
    "chromanoise simulate 'a b.npz' --sensor x.csv --pixel 'p q.txt' --prnu 0.01 --row-noise-e 2.0 "
    "--bits 10 --gain-dn-per-e 0.5 --seed 3 --shape 2x3 --mosaic bayer --frames 2 --format raw,png",
    "chromanoise simulate a.npz --sensor x.csv --crosstalk 0.1 --mosaic bayer",
    "chromanoise simulate a.npz --sensor x.csv --crosstalk mix.csv --mosaic sensor",
    "chromanoise analyze x.csv --dark-current-e-per-s 5.0 --temperature-c 40.0 "
    "--dark-reference-c 20.0 --dark-doubling-k 6.0 --dsnu-e 1.0 --prnu 0.01 --row-noise-e 1.0 "
    "--black-error-e -2.0 --bits 12 --gain-dn-per-e 0.5 --crosstalk 0.1 --crosstalk-stage charge "
    "--mosaic bayer",
    "chromanoise matrix x.csv --bits 10 --crosstalk 'a b.csv'",
]


@pytest.mark.parametrize("line", COMMANDS)
def test_the_command_of_a_study_is_the_one_that_it_was_copied_from(done, line):
    out, _ = done(*shlex.split(line)[1:], "--copy-as", "toml")
    command, _, folder = study_as_command(study_from_text(out, source="copied")).partition(
        " --out "
    )
    assert command == line
    assert folder.startswith("out/simulate-") == ("simulate" in line)


MINE = {"name": "my cam.csv", "beyond": "zero", "answers": {"scale": "percent"}}
TWICE = [  # a study of each kind, with a file, labels, pictures and sweeps
    {"matrices": ["kernel", "lmmse"]},
    {"sensors": [MINE | {"label": "it's mine"}]},
    {"sensors": [MINE], "pictures": [{}]},
    {"sweeps": [{"vary": "lux", "first": 0.1, "last": 10.0, "points": 2}]},
]


@pytest.mark.evidence
def test_copied_commands_run_twice_in_one_folder_and_beside_each_other(
    run, curves, monkeypatch, tmp_path
):
    monkeypatch.chdir(tmp_path)
    folders = []
    for part in TWICE:
        for lux in (3.0, 4.0):
            data = {"sensors": [{"name": "onyx-rgbw"}], "light": {"level_lux": lux}} | part
            command = study_as_command(study_from_data(data, source=""))
            line, _, text = command.partition(" <<'STUDY'\n")
            (tmp_path / "stdin.toml").write_text(text.removesuffix("STUDY"))
            words = ["stdin.toml" if one == "/dev/stdin" else one for one in shlex.split(line)]
            folders += words[words.index("--out") + 1 :][:1] if "--out" in words else []
            printed = [run(*words[1:]) for _ in range(2)]
            assert [code for code, _, _ in printed] == [0, 0], printed
    assert len(set(folders)) == len(folders) == 6


@pytest.mark.parametrize(
    "text",
    [
        '[[sensors]]\nname = "onyx-rgbw"\n[[sensors]]\nname = "onyx-rgbw"\nshift_nm = 5.0\n',
        'matrices = ["kernel", "lmmse"]\n[[sensors]]\nname = "onyx-rgbw"\n',
        'title = "STUDY\\nSTUDY"\n[[sensors]]\nname = "onyx-rgbw"\n[[pictures]]\n',
    ],
)
def test_what_no_single_command_says_is_a_run_of_the_study_itself(text, tmp_path):
    study = study_from_text(text, source="text")
    line = study_as_command(study)
    assert line.startswith("chromanoise run /dev/stdin")
    stand_in = f"chromanoise() {{ cat {tmp_path}/none /dev/stdin 2>{tmp_path}/err; }}\n"
    done = subprocess.run(["bash", "-c", stand_in + line], capture_output=True, text=True)
    assert study_from_text(done.stdout, source="shell") == study


OWN = "own camera.json"


@pytest.mark.parametrize("more", [(), ("--read-noise-e", 2), ("--filter", "ircut-700")])
def test_a_copied_script_knows_a_users_file_and_a_sensor_of_our_own_json(
    done, tmp_path, curves, more, capsys, monkeypatch, result_of
):
    own = tmp_path / OWN
    done("convert", "model-rgb", own)
    options = (curves, own, "--percent", "--beyond", "zero", "--lux", 2, "--budget", *more)
    out, _ = done("analyze", *options, "--copy-as", "python")
    (tmp_path / "s.py").write_text(out)
    monkeypatch.chdir(tmp_path)
    runpy.run_path("s.py", run_name="__main__")
    assert json.loads(capsys.readouterr().out) == [result_of("analyze", *options)]


@pytest.mark.parametrize("more", [(), ("--copy-as", "toml")])
@pytest.mark.parametrize(
    ("options", "answer", "value", "parts"),
    [
        (
            ("onyx-rgbw", "--peak-qe", 0.3, "--energy"),
            *("per", "energy", ["onyx-rgbw", "--energy", "--peak-qe"]),
        ),
        (
            ("onyx-rgbw", "mt9m131", "--photons"),
            *("per", "photon", ["onyx-rgbw", "mt9m131", "--photons"]),
        ),
        (
            ("ar0132at-rgbw", "--peak-qe", 0.5, "--percent"),
            *("scale", "percent", ["ar0132at-rgbw", "--percent"]),
        ),
        (
            ("nikon-d5100-npl", "--energy", "--um"),
            *("wavelength_unit", "um", ["nikon-d5100-npl", "--wavelength-unit"]),
        ),
        (("own.json", "--relative"), "level", "relative", ["own.json", "--relative"]),
        (
            ("qe.csv", "--absolute", "--peak-qe", 0.5),
            *("peak_qe", 0.5, ["qe.csv", "--peak-qe"]),
        ),
    ],
)
def test_an_answer_that_no_sensor_asks_for_is_refused(
    run, tmp_path, monkeypatch, options, answer, value, parts, more
):
    monkeypatch.chdir(tmp_path)
    assert run("convert", "model-rgb", "own.json")[0] == 0
    (tmp_path / "qe.csv").write_text("wavelength_nm,W\n400,0.4\n1050,0.5\n")
    outcome = run("analyze", *options, *more)
    refused(outcome, *parts, setting=f"sensors.0.answers.{answer}", value=value)


def test_an_answer_that_one_of_several_sensors_asks_for_is_taken(result_of):
    options = ("onyx-rgbw", "ar0132at-rgbw", "--peak-qe", 0.3, "--beyond", "zero")
    result = result_of("analyze", *options)
    assert [one["name"] for one in result["sensors"]] == ["onyx-rgbw", "ar0132at-rgbw"]


@pytest.mark.parametrize("option", ["--illuminant-photons", "--illuminant-energy"])
def test_a_light_by_name_is_asked_nothing(run, option):
    result = run("analyze", "onyx-rgbw", "--illuminant", "A+1xLED850", option)
    refused(result, option, "A+1xLED850", setting="light.per")
    result = run("analyze", "onyx-rgbw", "--illuminant-column", "x")
    refused(result, "--illuminant-column", setting="light.column", value="x")
