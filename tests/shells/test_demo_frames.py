"""`demo-frames`: a folder of frames with their description, or one sentence."""

import tomllib

import numpy as np
import pytest

from chromanoise.base.files import OWN_FILES
from outcomes import refused

pytestmark = pytest.mark.usefixtures("here")
SMALL = ("--shape", "20x24", "--levels", 3)


def toml(path):
    return tomllib.loads(path.read_text(encoding="utf-8"))


def test_the_command_writes_frames_their_description_and_the_truth(done, here):
    out, err = done("demo-frames", "-o", "cam", *SMALL, "--frames", 3, "--mosaic", "RG/GB")
    assert (len(out.splitlines()), err) == (2, "")
    capture = toml(here / "cam" / "capture.toml")
    names = [name for level in capture["levels"] for name in level["flats"] + level["darks"]]
    assert [len(level["flats"]) for level in capture["levels"]] == [3, 3, 3]
    files = {path.name for path in (here / "cam").iterdir()}
    assert {*names, "capture.toml", "truth.toml", OWN_FILES} == files
    assert all(np.load(here / "cam" / name).shape == (20, 24) for name in names)
    planes = toml(here / "cam" / "truth.toml")["planes"]
    assert [plane["name"] for plane in planes] == ["R", "G1", "G2", "B"]
    assert planes[0]["qe"] < planes[1]["qe"]


def test_every_option_reaches_the_camera(done, here):
    values = {
        "gain_dn_per_e": 0.7, "read_noise_e": 2.5, "full_well_e": 9000.0, "bits": 14,
        "qe": 0.4, "dark_current_e_per_s": 7.0, "prnu": 0.004, "dsnu_e": 0.8,
        "row_noise_e": 0.25, "column_noise_e": 0.125, "hot_pixels": 2, "bend": 0.05,
        "drift": 0.0001, "neighbor_correlation": 0.1, "seed": 12,
    }  # fmt: skip
    options = [
        word for name, value in values.items() for word in (f"--{name.replace('_', '-')}", value)
    ]
    done("demo-frames", "-o", "cam", *SMALL, "--black-level", 100, *options)
    camera = toml(here / "cam" / "truth.toml")["camera"]
    assert camera["black_level_dn"] == 100.0
    assert {name: camera[name] for name in values} == values


def test_equal_commands_write_equal_files_and_another_seed_other_frames(done, here):
    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        done("demo-frames", "-o", folder, *SMALL, "--seed", seed, "--format", "pgm")
    for path in (here / "a").iterdir():
        assert path.read_bytes() == (here / "b" / path.name).read_bytes()
        if path.suffix == ".pgm":
            assert path.read_bytes() != (here / "c" / path.name).read_bytes()


@pytest.mark.parametrize(
    ("words", "option"),
    [
        (("--shape", "20"), "--shape"),
        (("--shape", "99999x99999"), "--shape"),
        (("--levels", 1), "--levels"),
        (("--frames", 10**12), "--frames"),
        (("--prnu", 5), "--prnu"),
        (("--gain-dn-per-e", "nan"), "--gain-dn-per-e"),
        (("--mosaic", "RG/G"), "--mosaic"),
        (("--black-level", 4096), "--black-level"),
        (("--format", "jpg"), "--format"),
        (("--drift", 0.001, "--drift", 0.002), "--drift"),
    ],
    ids=str,
)
def test_a_camera_that_cannot_be_leaves_one_sentence_and_no_folder(run, here, words, option):
    refused(run("demo-frames", "-o", "cam", *words), option)
    assert list(here.iterdir()) == []
