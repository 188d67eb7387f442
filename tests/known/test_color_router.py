"""A color router against an ideal Bayer mosaic, in a world of three bands."""

import numpy as np
import pytest

from chromanoise.sensor.filter_models import router_collection, router_shares
from chromanoise.spectra import Grid, cie_1931

GRID = Grid.uniform(400, 700, 5)
BANDS = {"crossing_nm": [490.0, 590.0], "edge_nm": 5.0}


def y_of(f):
    """SNR of Y [dB] of a white, by the kernel matrix and shot noise alone, and all electrons."""
    mean = f.sum(axis=0)
    weights = (cie_1931(GRID).values.T @ f @ np.linalg.inv(f.T @ f))[1]
    return 20 * np.log10(weights @ mean / np.sqrt(weights**2 @ mean)), mean.sum()


def test_a_router_collects_more_electrons_than_bayer_and_has_a_worse_y():
    # 84 % of the light, of its bands 49, 59 and 58 % in B, G and R; Bayer's filters transmit 90 %
    # of their band over a quarter, half and a quarter of the pixels
    collection = router_collection([0.49 / 0.84, 0.59 / 0.84, 0.58 / 0.84], 0.84)
    router_db, router_e = y_of(router_shares(GRID, collection=collection, **BANDS))
    bands = router_shares(GRID, collection=np.eye(3), **BANDS)
    bayer_db, bayer_e = y_of(0.9 * bands * [0.25, 0.5, 0.25])
    assert router_e / bayer_e == pytest.approx(2.8, abs=0.05)
    assert router_db - bayer_db == pytest.approx(-1.1, abs=0.1)


def test_a_perfect_router_gains_what_three_filters_stop_and_one_without_choice_splits_equally():
    collection = router_collection([1.0, 1.0, 1.0], 0.84)
    bands = router_shares(GRID, collection=np.eye(3), **BANDS)
    sorted_db, _ = y_of(router_shares(GRID, collection=collection, **BANDS))
    third_db, _ = y_of(bands / 3)
    assert sorted_db - third_db == pytest.approx(10 * np.log10(3 * 0.84), rel=1e-9)
    equal = router_shares(GRID, collection=router_collection([1 / 3] * 3, 1.0), **BANDS)
    np.testing.assert_allclose(equal, 1 / 3, rtol=1e-12)
