"""Two measured cameras, as colour-science carries them (NPL: Darrodi et al., JOSA A 32, 2015)."""

import colour
import numpy as np
import pytest

from chromanoise.geometry import angles_between_deg, dual_frame, nearest_mix, variance_inflation

RGB = ("R", "G", "B")


def camera(name):
    measured = colour.MSDS_CAMERA_SENSITIVITIES[name].copy()
    values = measured.align(colour.SpectralShape(400, 700, 5)).values
    return dual_frame(np.ascontiguousarray(values), names=RGB, metric="quanta")


def test_variance_inflation_of_the_sigma_merrill_is_that_of_stacked_silicon():
    # docs/numbers.md; three layers of one silicon, no filters: strongly correlated
    seen = variance_inflation(camera("Sigma SDMerill (NPL)"))
    assert seen == pytest.approx([8.44, 28.2, 11.6], abs=0.05)


@pytest.mark.parametrize("name", ["Nikon 5100 (NPL)", "Sigma SDMerill (NPL)"])
def test_angles_of_a_camera_are_arc_cosines_of_its_correlations(name):
    frame = camera(name)
    f = frame.basis
    by_arccos = [
        [np.degrees(np.arccos(min(1.0, a @ b / np.sqrt((a @ a) * (b @ b))))) for b in f.T]
        for a in f.T
    ]
    # arccos loses half the digits near 0 degrees, hence 1e-6
    assert angles_between_deg(frame) == pytest.approx(np.array(by_arccos), abs=2e-6)


@pytest.mark.parametrize("name", ["Nikon 5100 (NPL)", "Sigma SDMerill (NPL)"])
def test_variance_inflation_of_a_camera_is_1_over_1_minus_r_squared(name):
    # the statistician's definition: regress each channel on the others, no intercept
    frame = camera(name)
    expected = []
    for i in range(3):
        target, others = frame.basis[:, i], np.delete(frame.basis, i, axis=1)
        _, left, *_ = np.linalg.lstsq(others, target, rcond=None)
        expected.append(target @ target / left[0])
    assert variance_inflation(frame) == pytest.approx(expected, rel=1e-9)


def test_merrills_middle_layer_is_the_one_that_the_others_mix():
    mix = nearest_mix(camera("Sigma SDMerill (NPL)"))
    assert mix is not None
    assert mix.channel == "G"
    # arcsin(1 / sqrt(28.2)) = 10.85 deg
    assert mix.angle_deg == pytest.approx(10.85, abs=0.03)
    assert all(weight > 0 for weight in mix.weights.values())
