"""The evaluation of the package emva1288 of the same frames: temporal and spatial results."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import chromanoise as cn
from chromanoise.apps.camera import VirtualCamera, characterized, photon_transfer_frames
from chromanoise.io.frames import read_frame_set

NEEDS = "needs the package emva1288"
data = pytest.importorskip("emva1288.process.data", reason=NEEDS)
loader = pytest.importorskip("emva1288.process.loader", reason=NEEDS)
parser = pytest.importorskip("emva1288.process.parser", reason=NEEDS)
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


@pytest.fixture(autouse=True, scope="module")
def _numpy_1_name():
    # emva1288 1.0.2 still calls np.asfarray, which numpy 2 has dropped
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(np, "asfarray", lambda a: np.asarray(a, dtype=float), raising=False)
        yield


def stacked(group):
    return routines.get_int_imgs([frame.codes().astype(np.int64) for frame in group])


def summed(stack):
    return {"sum": stack["sum"].sum(), "pvar": stack["pvar"].sum(), "dmean": stack["dmean"]}


def theirs(frames, plane):
    half_dn = (plane.saturation_dn + plane.black_level_dn) / 2  # where PRNU is measured
    temporal, spatial, nearest = {}, {}, None
    for one in frames.levels:
        light = one.photons_per_pixel
        dark, bright = stacked(one.darks), stacked(one.flats)
        time_ns = 1e6 * one.time_ms
        temporal[time_ns] = {0.0: summed(dark), light: summed(bright)}
        away = abs(bright["sum"].mean() / 2 - half_dn)
        if nearest is None or away < nearest:
            nearest, spatial = away, {time_ns: {0.0: dark, light: bright}}
    height, width = CAMERA.shape
    values = {"width": width, "height": height, "temporal": temporal, "spatial": spatial}
    return results.Results1288(data.Data1288(values).data, pixel_area=1.0)


def evaluated(folder, camera, levels=30):
    """Our results and those of the reference code, of the same frames."""
    photon_transfer_frames(camera, folder=folder / "frames", levels=levels)
    frames = read_frame_set([folder / "frames"])
    (plane,) = characterized(frames).planes
    return plane, theirs(frames, plane)


@pytest.fixture(scope="module")
def usual(tmp_path_factory):
    return evaluated(tmp_path_factory.mktemp("emva"), CAMERA)


def test_temporal_results_are_those_of_the_reference_evaluation(usual):
    plane, other = usual
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
    assert plane.dark_noise_e == pytest.approx(other.sigma_d, rel=2e-3)


def test_spatial_results_are_those_of_the_reference_evaluation(usual):
    """Release 3.1, which emva1288 follows, has no high-pass: without shading it changes little."""
    plane, other = usual
    assert plane.dsnu_e == pytest.approx(other.DSNU1288, rel=1e-3)
    assert plane.dsnu_of_own_frames_e == pytest.approx(other.DSNU1288, rel=1e-3)
    assert plane.prnu == pytest.approx(other.PRNU1288 / 100, abs=1.5 * plane.prnu_se)


def test_row_noise_of_all_darks_is_subtracted_and_both_values_of_dsnu_are_stated(tmp_path):
    camera = replace(CAMERA, dsnu_e=3.0, row_noise_e=6.0)
    plane, other = evaluated(tmp_path, camera, levels=20)
    true = camera.planes()[0].dsnu_of_pixels_e
    assert plane.dsnu_of_own_frames_e == pytest.approx(other.DSNU1288, rel=0.01)
    assert abs(plane.dsnu_e - true) < 4 * plane.dsnu_e_se


def test_shading_changes_prnu_of_release_3_and_not_of_release_4(tmp_path):
    plane, other = evaluated(tmp_path, replace(CAMERA, shading=0.2))
    assert 3 * CAMERA.prnu < other.PRNU1288 / 100
    assert plane.prnu == pytest.approx(CAMERA.prnu, abs=4 * plane.prnu_se)


# ---- a descriptor with a spatial series ----

SERIES = {  # camera, photons of the spatial series as stated over the true ones, its time [ms]
    "of a level": (CAMERA, 1.0, 50.0),
    "of another calibration of the light": (replace(CAMERA, dsnu_e=3.0), 0.1, 20.0),
    "with row noise": (replace(CAMERA, dsnu_e=3.0, row_noise_e=5.0, column_noise_e=2.0), 0.5, 30.0),
}


@pytest.fixture(scope="module", params=SERIES)
def described(request, tmp_path_factory):
    """A descriptor as of a laboratory: pairs at 20 levels, and 50 flats and darks at one light."""
    camera, stated, time_ms = SERIES[request.param]
    folder, lines, photons = tmp_path_factory.mktemp("emva"), [], 1.1 * 9000.0 / 0.5

    def put(line, count, **light):
        lines.append(line)
        for _ in range(count):
            name = f"{len(lines)}.png"
            codes = camera.frame(number=len(lines), **light)
            Image.fromarray(codes).save(folder / name, compress_level=0)
            lines.append(f"i {name}")

    for share in np.linspace(0.05, 1.0, 20):
        time = 100.0 * share
        light = round(photons * share, 3)
        put(f"b {1e6 * time:.1f} {light:.3f}", 2, photons_per_pixel=light, time_ms=time)
        put(f"d {1e6 * time:.1f}", 2, dark=True, time_ms=time)
    half = 0.45 * photons
    put(f"b {1e6 * time_ms:.1f} {stated * half:.3f}", 50, photons_per_pixel=half, time_ms=time_ms)
    put(f"d {1e6 * time_ms:.1f}", 50, dark=True, time_ms=time_ms)
    path = folder / "descriptor.txt"
    path.write_text("\n".join(["v 4.0", f"n 12 {CAMERA.shape[1]} {CAMERA.shape[0]}", *lines]))
    return camera, path


@pytest.fixture
def both(described):
    """Our results and those of the reference code, of the same descriptor."""
    camera, path = described
    images = parser.ParseEmvaDescriptorFile(str(path)).images
    other = results.Results1288(data.Data1288(loader.LoadImageData(images).data).data)
    return camera, cn.characterize(path).planes[0], other


@pytest.mark.filterwarnings("ignore::ResourceWarning")  # of theirs
def test_a_spatial_series_gives_the_fixed_patterns_and_is_no_level_of_the_photon_transfer(both):
    camera, plane, other = both
    assert len(plane.levels) == 20
    assert plane.linearity_error_percent == pytest.approx(
        max(-other.LE_min, other.LE_max), rel=1e-6
    )
    # sums of squares over n and over degrees of freedom: 1 / rows where rows share noise
    share = (camera.row_noise_e / camera.planes()[0].dark_noise_e) ** 2
    assert plane.gain_dn_per_e == pytest.approx(other.K, rel=2e-4)
    assert plane.dark_noise_e == pytest.approx(other.sigma_d, rel=2e-4 + 2 * share / 100)
    assert plane.dsnu_e == pytest.approx(other.DSNU1288, rel=1e-3)
    assert plane.dsnu_of_own_frames_e == plane.dsnu_e
    assert plane.prnu == pytest.approx(other.PRNU1288 / 100, abs=1.5 * plane.prnu_se)
    truth = camera.planes()[0]
    for name, true in (
        ("gain_dn_per_e", truth.gain_dn_per_e),
        ("dark_noise_e", truth.dark_noise_e),
        ("dsnu_e", truth.dsnu_of_pixels_e),
        ("prnu", truth.prnu_of_pixels),
    ):
        assert abs(getattr(plane, name) - true) < 4 * getattr(plane, f"{name}_se"), name


@pytest.mark.filterwarnings("ignore::ResourceWarning")  # of theirs
def test_saturation_capacity_and_dynamic_range_are_those_of_the_reference_evaluation(both):
    _, plane, other = both
    assert plane.saturation_capacity_e == pytest.approx(other.u_e_sat, rel=2e-4)
    assert plane.dynamic_range_db == pytest.approx(other.DR_dB(), abs=0.03)  # sigma_d: see above
