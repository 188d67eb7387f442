"""scikit-image and colour-science as the other codes: PSNR, SSIM, CIEDE2000 of pictures."""

import colour
import numpy as np
import pytest

from chromanoise.metrics import picture_color_difference, psnr_db, structural_similarity

metrics = pytest.importorskip("skimage.metrics")


def pictures(seed, shape=(40, 33, 3), sd=0.1):
    rng = np.random.default_rng(seed)
    reference = np.cumsum(rng.uniform(0, 1 / shape[0], shape), axis=0)
    return np.clip(reference + rng.normal(0, sd, shape), 0, 1), reference


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("peak", [1.0, 255.0])
def test_psnr_is_that_of_scikit_image(seed, peak):
    picture, reference = pictures(seed)
    theirs = metrics.peak_signal_noise_ratio(peak * reference, peak * picture, data_range=peak)
    assert psnr_db(peak * picture, peak * reference, peak=peak) == pytest.approx(theirs, abs=1e-9)


@pytest.mark.parametrize("sd", [0.01, 0.1, 0.5])
@pytest.mark.parametrize("peak", [1.0, 255.0])
def test_ssim_is_that_of_scikit_image_with_the_window_of_wang(sd, peak):
    picture, reference = (peak * one[..., 1] for one in pictures(4, sd=sd))
    theirs = metrics.structural_similarity(
        picture,
        reference,
        data_range=peak,
        gaussian_weights=True,
        sigma=1.5,
        use_sample_covariance=False,
    )
    assert structural_similarity(picture, reference, peak=peak) == pytest.approx(theirs, abs=1e-9)


def test_ciede2000_of_a_picture_is_that_of_colour_science_also_below_zero():
    white = np.array([1.0985, 1.0, 0.3558])
    picture, reference = (white * (one - 0.1) for one in pictures(6))
    lab = (colour.XYZ_to_Lab(one, colour.XYZ_to_xy(white)) for one in (reference, picture))
    theirs = colour.delta_E(*lab, method="CIE 2000")
    assert picture_color_difference(picture, reference, white) == pytest.approx(theirs, abs=1e-9)
