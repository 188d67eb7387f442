"""``chromanoise characterize``: frames in, planes and a pixel file out."""

import json
import tomllib

import numpy as np
import pytest

import chromanoise as cn
from outcomes import refused


@pytest.fixture
def frames(done, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done("demo-frames", "-o", "frames", "--mosaic", "RG/GB", "--levels", 8, "--shape", "64x80")
    return tmp_path / "frames"


def test_json_has_the_digits_of_the_library_and_the_keys_that_scripts_use(result_of, frames):
    data = result_of("characterize", "frames")
    assert data == json.loads(json.dumps(cn.characterize("frames").to_dict()))
    for plane in data["planes"]:
        assert plane["gain_dn_per_e"] == pytest.approx(0.3, abs=5 * plane["gain_dn_per_e_se"])
        assert len(plane["levels"]) == 8


@pytest.mark.evidence
def test_the_pixel_file_is_taken_by_analyze_with_the_values_found(done, frames, tmp_path):
    done("characterize", "frames", "-o", "camera")
    pixel = tomllib.loads((tmp_path / "camera" / "pixel.toml").read_text())
    (analysis,) = cn.analyze("model-rgb-ircut", pixel="camera/pixel.toml").analyses
    used = analysis.sensor.pixel
    for name in ("full_well_e", "read_noise_e", "prnu", "dsnu_e", "row_noise_e"):
        assert getattr(used, name) == pixel[name]
    assert analysis.sensor.converter.gain_e_per_dn == pixel["gain_e_per_dn"]


def test_the_table_names_each_plane_and_the_verdict(done, frames):
    out, _ = done("characterize", "frames")
    for part in ("G1", "gain K", "DN/e-", "PRNU", "linear model"):
        assert part in out


def test_an_output_folder_is_whole_or_absent(run, frames, tmp_path):
    (tmp_path / "taken").write_text("mine")
    refused(run("characterize", "frames", "-o", "taken"), "taken")
    assert (tmp_path / "taken").read_text() == "mine"


def test_a_folder_that_is_missing_or_empty_is_refused_by_name(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    for name in ("nowhere", "empty"):
        refused(run("characterize", name), name)


def test_frames_without_a_list_of_levels_are_grouped_by_their_names(result_of, frames):
    (frames / "capture.toml").unlink()
    (plane,) = result_of("characterize", "frames")["planes"]  # no file states the mosaic
    assert plane["name"] == "mono"
    assert len(plane["levels"]) == 8
    assert {level["frames"] for level in plane["levels"]} == {2}


def test_a_damaged_frame_is_named(run, frames):
    path = sorted(frames.glob("*.npy"))[3]
    path.write_bytes(path.read_bytes()[:500])
    refused(run("characterize", "frames"), path.name)


def test_a_later_run_goes_on_from_the_statistics_of_an_earlier_one(run, frames, tmp_path):
    words = ("characterize", "frames", "--resume", "kept.json", "--json", "-")
    first = run(*words)
    assert len(json.loads((tmp_path / "kept.json").read_text())["lights"]) == 16
    assert run(*words) == first
    np.save(sorted(frames.glob("*.npy"))[0], np.zeros((64, 80), np.uint16))
    assert run(*words) != first


def test_kept_statistics_that_were_changed_are_refused(run, frames, tmp_path):
    run("characterize", "frames", "--resume", "kept.json", "--json", "-")
    kept, first = tmp_path / "kept.json", (tmp_path / "kept.json").read_text()
    for old, new in (('"planes": [{', '"planes": [], "x": [{'), ("1", "2"), ("e", "E")):
        kept.write_text(first.replace(old, new, 1))
        refused(run("characterize", "frames", "--resume", "kept.json"), "kept.json")
        assert kept.read_text() == first.replace(old, new, 1)


@pytest.mark.parametrize("up", [60, 3])
def test_parent_folders_after_a_wildcard_are_refused(run, frames, up):
    (frames / "inner").mkdir()
    text = f'darks = ["{"*/../" * up}*.npy"]\n[[levels]]\nflats = ["*.npy"]\n'
    (frames / "capture.toml").write_text(text)
    refused(run("characterize", "frames"), "..")


@pytest.mark.parametrize(
    ("option", "target"),
    [
        ("--json", "frames/level-01-flat-1.npy"),
        ("--json", "frames/capture.toml"),
        ("--resume", "frames/level-01-dark-1.npy"),
        ("-o", "frames"),
    ],
)
def test_frames_are_never_replaced_by_outputs(run, frames, option, target):
    before = {path.name: path.read_bytes() for path in frames.iterdir()}
    refused(run("characterize", "frames", option, target), target)
    assert {path.name: path.read_bytes() for path in frames.iterdir()} == before


@pytest.mark.parametrize(
    ("target", "words", "named"),
    [
        ("loop.json", ("--resume", "loop.json"), "loop.json"),
        ("loop.json", ("--json", "loop.json"), "loop.json"),
        ("frames/level-01-flat-1.npy", ("--json", "loop.json"), "loop.json"),
        ("b", ("--json", "a", "--resume", "a"), "--resume"),
    ],
    ids=["resume from a loop of links", "JSON into a loop", "a link to a frame", "two outputs"],
)
def test_a_link_in_a_loop_or_to_another_file_is_no_output(
    run, frames, tmp_path, target, words, named
):
    (tmp_path / "loop.json").symlink_to(target)
    refused(run("characterize", "frames", *words), named)


def test_frames_are_not_mixed_with_those_of_another_demo(run, frames):
    refused(run("demo-frames", "-o", "frames"), "frames")


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"flats": "other", "darks": "flats", "other": "darks"}, "-flat-1.npy"),
        ({"bits = 12": "bits = 8"}, "255"),
    ],
)
def test_exchanged_frames_and_codes_beyond_the_bits_are_refused(run, frames, changes, named):
    toml = (frames / "capture.toml").read_text()
    for old, new in changes.items():
        toml = toml.replace(old, new)
    (frames / "capture.toml").write_text(toml)
    refused(run("characterize", "frames"), named)


@pytest.mark.evidence
def test_a_table_of_means_and_variances_gives_the_values_of_its_plane(done, frames):
    done("characterize", "frames", "-o", "camera")
    (plane,) = cn.characterize("camera/photon_transfer_R.csv").planes
    whole = cn.characterize("frames").planes[0]
    for name in ("gain_dn_per_e", "dark_noise_e", "qe", "dark_current_e_per_s"):
        assert getattr(plane, name) == pytest.approx(getattr(whole, name), rel=1e-9)
    assert plane.prnu is plane.row_noise_e is None
