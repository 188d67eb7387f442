"""Random virtual cameras against what is found of them: `tools/virtual_cameras.py`."""

import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

import chromanoise as cn
import virtual_cameras
from virtual_cameras import OF_PIXELS, PARAMETERS, findings, random_camera, scores, table

CAMERAS = 200


def characterize_by_the_truth(spread, shift=0.0, hidden=()):
    """Stands in for a characterization that errs by ``spread`` and ``shift`` stated errors."""
    rng = np.random.default_rng(4)

    def characterize(folder):
        data = tomllib.loads((folder / "truth.toml").read_text())["planes"]
        planes = []
        for plane in data:
            values = {"name": plane["name"]}
            for name in PARAMETERS:
                error = 0.01 * plane[name] + 1e-3
                z = shift + spread * rng.standard_normal()
                values[name] = None if name in hidden else plane[name] + z * error
                values[f"{name}_se"] = None if name in hidden else error
            planes.append(SimpleNamespace(**values))
        return SimpleNamespace(planes=planes)

    return characterize


def found_by(monkeypatch, characterize, cameras):
    def few(camera, **settings):
        return written(camera, levels=2, darks=1, **settings)

    written = virtual_cameras.photon_transfer_frames
    monkeypatch.setattr(virtual_cameras, "photon_transfer_frames", few)
    monkeypatch.setattr(cn, "characterize", characterize, raising=False)
    return [one for number in range(cameras) for one in findings(1, number)]


@pytest.mark.evidence
def test_the_scores_find_errors_that_are_too_small_and_a_bias(monkeypatch):
    found = found_by(monkeypatch, characterize_by_the_truth(2.0, 0.5, hidden=("qe",)), 20)
    score = scores(found)
    planes = len({(one.camera, one.true) for one in found if one.parameter == "qe"})
    assert (score["qe"].values, score["qe"].missing) == (0, planes)
    assert score["all"].values == planes * (len(PARAMETERS) - 1)
    root = np.sqrt(score["all"].values)
    assert abs(score["all"].mean_z - 0.5) < 5 * 2.0 / root
    assert abs(score["all"].sd_z - 2.0) < 5 * 2.0 / np.sqrt(2) / root
    inside = 0.8543  # of a Gaussian with mean 0.5 and standard deviation 2, within 3
    assert abs(score["all"].within_3 - inside) < 5 * np.sqrt(inside * (1 - inside)) / root
    assert len(table(found).splitlines()) == len(PARAMETERS) + len(OF_PIXELS) + 2


def test_random_cameras_depend_on_their_number_only_and_can_be_measured():
    again = [random_camera(2, n) for n in reversed(range(50))][::-1]
    cameras = [random_camera(2, n) for n in range(50)]
    assert cameras == again
    assert len(set(cameras)) == 50
    for camera in cameras:
        for plane in camera.planes():
            dark_dn = np.hypot(plane.dark_noise_e, plane.dsnu_e) * plane.gain_dn_per_e
            assert plane.black_level_dn > 3.5 * dark_dn  # no code is clipped at 0
            assert plane.full_well_e > 20 * plane.dark_noise_e
            assert 0.05 <= plane.gain_dn_per_e <= 20


@pytest.mark.evidence
@pytest.mark.skipif(not hasattr(cn, "characterize"), reason="characterize is not there yet")
def test_stated_errors_of_characterized_cameras_are_right():
    found = [one for number in range(CAMERAS) for one in findings(1, number)]
    fine = [one for one in found if not one.coarse]
    print(table(fine))
    for name in (*PARAMETERS, "all"):
        score = scores(fine)[name]
        assert score.within_3 >= 0.99, name
        assert 0.9 < score.sd_z < 1.1, name
