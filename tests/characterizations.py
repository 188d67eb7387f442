"""A characterization of a made-up camera, for tests of what is written about it."""

from dataclasses import replace

import numpy as np

from chromanoise.apps.camera import Characterization, ModelVerdict, characterized_table
from chromanoise.sensor import Mosaic, PhotonTransfer

BAYER = Mosaic((("R", "G1"), ("G2", "B")))
SAMPLES = 200_000.0
BLACK_DN, DARK_E, WELL_E, QE, TIME_UNIT_MS = 64.25, 5.0, 7500.0, 0.61, 3.0


def plane_of(
    name="mono", *, gain=0.5, seed=1, light=1.0, black_dn=BLACK_DN, dark_e=DARK_E, **given
):
    """A plane with levels from 1 % to 105 % of saturation, variances drawn with their errors."""
    rng = np.random.default_rng(seed)
    electrons = np.minimum(
        light * WELL_E * np.array([0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 1, 1.2]), WELL_E
    )
    times = TIME_UNIT_MS * np.arange(1, 10)
    dark_dn2 = (gain * dark_e) ** 2 + 1 / 12
    true = dark_dn2 + gain**2 * electrons
    true[electrons >= WELL_E] *= 0.3
    variance = true * (1 + np.sqrt(2 / (SAMPLES - 1)) * rng.standard_normal(true.size))
    table = PhotonTransfer(
        mean_dn=black_dn + gain * electrons,
        variance_dn2=variance,
        dark=np.zeros(true.size, dtype=bool),
        samples=np.full(true.size, SAMPLES),
        dark_mean_dn=np.full(true.size, black_dn),
        dark_variance_dn2=np.full(true.size, dark_dn2),
        time_ms=times,
        photons=electrons / QE,
    )
    (plane,) = characterized_table(table).planes
    usual = {"correlation_right": 0.001, "correlation_down": -0.0005, "drift_z": 0.7}
    levels = (replace(one, name=f"level {i}", **usual) for i, one in enumerate(plane.levels))
    values = {
        "black_level_dn": black_dn,
        "black_level_dn_se": 0.01,
        "full_well_e_se": 12.0,
        "qe": QE,
        "qe_se": 0.004,
        "linearity_error_percent": 0.12,
        "dark_current_e_per_s": 3.25,
        "dark_current_e_per_s_se": 0.2,
        "dsnu_e": 1.1,
        "dsnu_e_se": 0.02,
        "dsnu_of_own_frames_e": 1.15,
        "prnu": 0.0061,
        "prnu_se": 0.0001,
        "row_noise_e": 0.0,
        "row_noise_e_se": 0.01,
        "column_noise_e": 0.1,
        "column_noise_e_se": 0.01,
        "hot_pixels": 3,
        "levels": tuple(levels),
    }
    return replace(plane, name=name, **(values | given))


def exact_plane(name="mono", **given):
    """A plane of K = 0.5 DN/e-, sigma_d = 5 e-, black level 55 DN, to the last digit."""
    values = {"gain_dn_per_e": 0.5, "dark_noise_e": 5.0, "black_level_dn": 55.0}
    return replace(plane_of(name), **(values | given))


def monochrome(**given):
    """One plane."""
    return _camera(**({"planes": (plane_of(),), "mosaic": None} | given))


def color(**given):
    """Four planes of a Bayer mosaic, of the same gain but for sampling."""
    planes = tuple(
        plane_of(name, seed=seed, light=light, row_noise_e=3.0)
        for seed, (name, light) in enumerate((("R", 0.9), ("G1", 1.0), ("G2", 1.0), ("B", 0.85)))
    )
    return _camera(**({"planes": planes, "mosaic": BAYER} | given))


def _camera(**given):
    values = {
        "source": "frames",
        "camera": "Acme Model One",
        "iso": 100.0,
        "bits": 12,
        "correlation": np.eye(len(given["planes"])),
        "covariance_dn2": np.ones((1, len(given["planes"]), len(given["planes"]))),
        "verdict": ModelVerdict(
            holds=True, chi2_per_level=1.02, worst_level="level 3", worst_z=1.7, sentences=()
        ),
        "notes": ("frames: 9 levels of 2 flats and 2 darks, by file name",),
    }
    return Characterization(**(values | given))
