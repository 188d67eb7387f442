"""The camera's own pipeline against draws through colour-science: matrix, tone curve, Y'CbCr, Lab.

Electrons are drawn, and every step behind the raw is colour-science's own function.
"""

from functools import cache, partial

import colour
import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.noise import (
    Exposure,
    expected_electrons,
    noise_sources,
    sample_electrons,
)
from chromanoise.sensor import with_pixel
from chromanoise.spectra import DEFAULT_GRID, Scene, colorchecker, equal_energy, flat_field
from chromanoise.study import (
    PipelineSettings,
    analyzed,
    matrix_makers,
    pipeline_noise,
    sensor_named,
)
from dear import dear_if
from strategies import point_of

LAMP = equal_energy(DEFAULT_GRID)
RHO = colorchecker(DEFAULT_GRID).values.T
D65_WHITE = np.array([0.95047, 1.0, 1.08883])
DRAWS = 20_000
FULL_PIXEL = {
    "prnu": 0.01, "dsnu_e": 3.0, "row_noise_e": 2.0, "dark_current_e_per_s": 500.0, "bits": 11,
    "black_error_e": 4.0,
}  # fmt: skip
TONES = {
    "srgb": colour.models.eotf_inverse_sRGB,
    "rec709": colour.models.oetf_BT709,
    "linear": np.asarray,
    2.2: partial(colour.gamma_function, exponent=1 / 2.2, negative_number_handling="Mirror"),
}
CASES = [
    ("model-rgb-ircut", "kernel", {}, {}),
    ("model-rgb-ircut", "lmmse", FULL_PIXEL, {"saturation": 1.3, "luma": "bt601"}),
    ("model-cmy-ircut", "lmmse", {}, {"tone": "rec709", "exposure_gain": 0.5}),
    ("onyx-rgbw", "lmmse", FULL_PIXEL, {"tone": 2.2, "saturation": 0.6, "white_balance": True}),
    ("onyx-rgb-ircut", "white-preserving", {}, {"tone": "linear"}),
]
IDS = [f"{name}-{matrix}-{more.get('tone', 'srgb')}" for name, matrix, _, more in CASES]


@cache
def analysis_of(name, matrix, pixel):
    sensor = with_pixel(sensor_named(name, DEFAULT_GRID), dict(pixel))
    point = point_of(sensor, exposure=Exposure(time_s=0.011))
    maker = matrix_makers([matrix], "quanta", prior="chart")[matrix]
    return analyzed(flat_field(LAMP, level_lux=10.0), sensor, point.exposure, matrix=maker(point))


def drawn_raw(analysis, seed):
    scene = Scene(illuminant=LAMP, level_lux=10.0, reflectance=RHO)
    electrons = expected_electrons(scene, analysis.sensor, analysis.exposure)
    return sample_electrons(
        np.broadcast_to(electrons, (DRAWS, *electrons.shape)),
        analysis.sensor.pixel,
        stream(seed),
        noise=noise_sources(analysis.sensor, analysis.exposure),
    )


def their_pipeline(analysis, raw, gains, more):
    """Each step of the drawn raw by colour-science; gains relative to those of the white."""
    white = analysis.expected_e @ analysis.matrix.matrix.T
    green = (
        analysis.expected_e[analysis.sensor.names.index("G")]
        if "G" in (analysis.sensor.names)
        else analysis.expected_e.max()
    )
    xyz = (raw * gains * analysis.expected_e / green) @ analysis.matrix.matrix.T / white[1]
    adapted = colour.adaptation.chromatic_adaptation_VonKries(
        xyz, white / white[1], D65_WHITE, transform="Bradford"
    )
    space = colour.RGB_COLOURSPACES["sRGB"]
    rgb = more.get("exposure_gain", 1.0) * adapted @ space.matrix_XYZ_to_RGB.T
    luma = rgb @ np.array([0.2126, 0.7152, 0.0722])
    rgb = luma[..., None] + more.get("saturation", 1.0) * (rgb - luma[..., None])
    encoded = TONES[more.get("tone", "srgb")](rgb)
    weights = {"bt709": "ITU-R BT.709", "bt601": "ITU-R BT.601"}[more.get("luma", "bt709")]
    ycbcr = colour.RGB_to_YCbCr(
        encoded,
        K=colour.WEIGHTS_YCBCR[weights],
        in_legal=False,
        out_legal=False,
    )
    back = rgb @ np.linalg.inv(space.matrix_XYZ_to_RGB).T
    lab = colour.XYZ_to_Lab(back, colour.XYZ_to_xy(D65_WHITE))
    return {"linear": rgb, "encoded": encoded, "ycbcr": ycbcr, "lab": lab}


def z_scores(drawn, measurement):
    """Of the means, standard deviations and correlations of draws, from the draws' own scatter."""
    away = drawn - drawn.mean(axis=0)
    variance = (away**2).mean(axis=0)
    mean_z = (drawn.mean(axis=0) - measurement.mean) / np.sqrt(variance / DRAWS)
    products = away[..., :, None] * away[..., None, :]
    se = products.std(axis=0) / np.sqrt(DRAWS)
    return mean_z, (products.mean(axis=0) - measurement.covariance) / se


@pytest.mark.evidence
@pytest.mark.parametrize(
    ("name", "matrix", "pixel", "more"), dear_if(lambda one: not one[2], CASES), ids=IDS
)
def test_draws_through_colour_science_scatter_as_predicted(name, matrix, pixel, more):
    analysis = analysis_of(name, matrix, tuple(pixel.items()))
    settings = dict(more)
    if settings.pop("white_balance", False):
        settings["white_balance"] = (0.68, 0.9, 0.99, 0.46)
    found = pipeline_noise(analysis, PipelineSettings(**settings))
    theirs = their_pipeline(analysis, drawn_raw(analysis, 15), found.gains, more)
    steps = {step.name: step.measurement for step in found.steps}
    ours = {
        "linear": steps["saturation"],
        "encoded": found.steps[-3].measurement,
        "ycbcr": steps["Y'CbCr"],
        "lab": steps["Lab"],
    }
    for step, drawn in theirs.items():
        mean_z, covariance_z = z_scores(drawn, ours[step])
        assert np.abs(mean_z).max() < 5, step
        assert np.abs(covariance_z).max() < 5, step


@pytest.mark.evidence
def test_chroma_of_a_gray_has_no_mean_but_noise():
    """By colour-science a neutral has Cb = Cr = 0; its chroma noise remains."""
    found = pipeline_noise(analysis_of("onyx-rgb-ircut", "white-preserving", ()))
    step = {one.name: one.measurement for one in found.steps}["Y'CbCr"]
    theirs = colour.RGB_to_YCbCr(
        np.full(3, 0.5), K=colour.WEIGHTS_YCBCR["ITU-R BT.709"], in_legal=False, out_legal=False
    )
    assert theirs[1:] == pytest.approx(0.0, abs=1e-12)
    assert np.abs(step.mean[18:, 1:]).max() < 0.05
    assert (np.sqrt(step.variance[18:, 1:]) > 1e-3).all()
