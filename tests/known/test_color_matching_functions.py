"""Angles between the axes of color: the eye's own noise geometry (docs/numbers.md)."""

import colour
import numpy as np
import pytest

from chromanoise.geometry import (
    angles_between_deg,
    angles_to_axes_deg,
    dual_frame,
    variance_inflation,
)
from chromanoise.spectra import Grid, color_axes

CIE = Grid.uniform(360, 830, 1)


def axes(metric):
    return dual_frame(color_axes(CIE, metric), names=("x", "y", "z"), metric=metric)


@pytest.mark.parametrize(
    ("metric", "xy", "xz", "yz"),
    [("energy", 40.520, 75.232, 85.314), ("quanta", 42.693, 70.674, 84.951)],
)
def test_angles_between_x_y_and_z(metric, xy, xz, yz):
    angles = angles_between_deg(axes(metric))
    assert [angles[0, 1], angles[0, 2], angles[1, 2]] == pytest.approx([xy, xz, yz], abs=6e-4)
    assert angles == pytest.approx(angles.T, abs=1e-12)
    assert np.diagonal(angles) == pytest.approx(np.zeros(3), abs=1e-12)


def test_angles_to_the_axes_are_told_channel_by_row_and_axis_by_column():
    # y alone as a channel: its angles to x, y and z are the printed ones
    h = color_axes(CIE, "energy")
    y_alone = dual_frame(h[:, [1]], names=("y",), metric="energy")
    assert angles_to_axes_deg(y_alone, h) == pytest.approx(
        np.array([[40.520, 0.0, 85.314]]), abs=6e-4
    )


def test_variance_inflation_of_x_y_and_z():
    assert variance_inflation(axes("energy")) == pytest.approx([2.5994, 2.4468, 1.1047], abs=6e-5)


def test_a_lumen_at_555_nm_costs_a_683rd_of_a_watt_and_4_1e15_photons():
    # K_m = 683.002 lm/W; one photon of 555 nm is 3.5792e-19 J (CODATA h c = 1.98645e-25 J m)
    at = 195  # 555 nm
    lux_per_watt = color_axes(CIE, "energy")[at, 1]
    lux_per_photon = color_axes(CIE, "quanta")[at, 1]  # of photons s-1 um-2 nm-1
    assert lux_per_watt == pytest.approx(683.002, rel=1e-6)
    assert lux_per_photon / 1e12 == pytest.approx(683.002 * 3.5792e-19, rel=2e-5)


@pytest.mark.parametrize(
    ("observer", "theirs", "energy", "quanta"),
    [
        (
            "cie-1964-10",
            "CIE 1964 10 Degree Standard Observer",
            [37.842, 74.942, 83.015],
            [40.017, 70.291, 82.160],
        ),
        (
            "cie-2015-2",
            "CIE 2015 2 Degree Standard Observer",
            [38.638, 76.345, 84.695],
            [40.678, 71.924, 84.032],
        ),
        (
            "cie-2015-10",
            "CIE 2015 10 Degree Standard Observer",
            [38.023, 74.830, 82.859],
            [40.169, 70.130, 81.881],
        ),
    ],
)
def test_angles_between_the_axes_of_other_observers(observer, theirs, energy, quanta):
    table = colour.MSDS_CMFS[theirs]
    for metric, printed in (("energy", energy), ("quanta", quanta)):
        per_unit = table.values / (table.wavelengths[:, None] if metric == "quanta" else 1.0)
        unit = per_unit / np.linalg.norm(per_unit, axis=0)
        cosines = [unit[:, i] @ unit[:, j] for i, j in ((0, 1), (0, 2), (1, 2))]
        h = color_axes(CIE, metric, observer)
        frame = dual_frame(h, names=("x", "y", "z"), metric=metric)
        angles = angles_between_deg(frame)[[0, 0, 1], [1, 2, 2]]
        assert angles == pytest.approx(np.degrees(np.arccos(cosines)), abs=1e-6)
        assert angles == pytest.approx(printed, abs=6e-4)
