"""The evaluation of the package emva1288 of the same frames: temporal and spatial results."""

from dataclasses import replace

import numpy as np
import pytest

from chromanoise.characterization import VirtualCamera, characterized, photon_transfer_frames
from chromanoise.io.frames import read_frame_set

NEEDS = "needs the package emva1288"
data = pytest.importorskip("emva1288.process.data", reason=NEEDS)
results = pytest.importorskip("emva1288.process.results", reason=NEEDS)
routines = pytest.importorskip("emva1288.process.routines", reason=NEEDS)

CAMERA = VirtualCamera(
    shape=(100, 140),
    gain_dn_per_e=0.4,
    read_noise_e=5.0,
    full_well_e=9000.0,
    bits=12,
    black_level_dn=60,
    prnu=0.012,
    dsnu_e=6.0,
    qe=0.5,
    seed=9,
)


@pytest.fixture(autouse=True)
def _numpy_1_name(monkeypatch):
    # emva1288 1.0.2 still calls np.asfarray, which numpy 2 has dropped
    monkeypatch.setattr(np, "asfarray", lambda a: np.asarray(a, dtype=float), raising=False)


@pytest.fixture(scope="module")
def frames(tmp_path_factory):
    folder = tmp_path_factory.mktemp("emva") / "frames"
    photon_transfer_frames(CAMERA, folder=folder, levels=30)
    return read_frame_set([folder])


def theirs(frames):
    sums = {"temporal": {"dark": {}, "bright": {}}, "spatial": {"dark": {}, "bright": {}}}
    half = None
    for one in frames.levels:
        time_ns = 1e6 * one.time_ms
        photons = one.photons_per_pixel
        for kind, group, light in (("dark", one.darks, 0.0), ("bright", one.flats, photons)):
            pair = routines.get_int_imgs([frame.codes().astype(np.int64) for frame in group])
            sums["temporal"][kind].setdefault(time_ns, {})[light] = pair
            mean = pair["sum"].mean() / 2
            if kind == "bright" and (half is None or abs(mean - 1860) < abs(half[0] - 1860)):
                half = (mean, one)
    one = half[1]
    for kind, group, light in (
        ("dark", one.darks, 0.0),
        ("bright", one.flats, one.photons_per_pixel),
    ):
        stack = routines.get_int_imgs([frame.codes().astype(np.int64) for frame in group])
        sums["spatial"][kind] = {1e6 * one.time_ms: {light: stack}}
    return results.Results1288(data.Data1288(sums).data)


def test_temporal_results_are_those_of_the_reference_evaluation(frames):
    (plane,) = characterized(frames).planes
    other = theirs(frames)
    # emva1288 divides sums of squares by n, this code by the degrees of freedom of rows and columns
    pixels = CAMERA.shape[0] * CAMERA.shape[1]
    assert plane.gain_dn_per_e == pytest.approx(other.K, rel=3 / pixels)
    assert plane.qe == pytest.approx(other.QE / 100, rel=1e-4)
    assert plane.saturation_dn - plane.black_level_dn == pytest.approx(
        other.temporal["u_y"][other.index_u_ysat] - other.temporal["u_ydark"][0], abs=0.2
    )
    assert plane.saturation_capacity_e == pytest.approx(other.u_e_sat, rel=1e-4)
    assert plane.linearity_error_percent == pytest.approx(
        max(abs(other.LE_min), abs(other.LE_max)), rel=1e-4
    )
    assert plane.dark_noise_e == pytest.approx(other.sigma_d(), rel=2e-3)


def test_spatial_results_are_those_of_the_reference_evaluation(frames):
    """Release 3.1, which emva1288 follows, has no high-pass: without shading it changes little."""
    (plane,) = characterized(frames).planes
    other = theirs(frames)
    assert plane.dsnu_e == pytest.approx(other.DSNU1288, rel=1e-3)
    assert plane.prnu == pytest.approx(other.PRNU1288 / 100, abs=1.5 * plane.prnu_se)


def test_shading_changes_prnu_of_release_3_and_not_of_release_4(tmp_path):
    camera = replace(CAMERA, shading=0.2)
    photon_transfer_frames(camera, folder=tmp_path / "f", levels=30)
    frames = read_frame_set([tmp_path / "f"])
    (plane,) = characterized(frames).planes
    assert 3 * CAMERA.prnu < theirs(frames).PRNU1288 / 100
    assert plane.prnu == pytest.approx(CAMERA.prnu, abs=4 * plane.prnu_se)
