"""Bayer filters held against colour-demosaicing, where that is installed."""

import numpy as np
import pytest

from chromanoise.base.rng import stream
from chromanoise.imaging.demosaic import bilinear_filters, demosaicked, malvar_filters
from chromanoise.sensor import Mosaic

with np.printoptions():  # imported, it sets numpy's print options to those of 1.13 for all
    others = pytest.importorskip("colour_demosaicing")
PATTERNS = ["RGGB", "BGGR", "GRBG", "GBRG"]
every_pattern = pytest.mark.parametrize("pattern", PATTERNS)


def mosaic_of(pattern):
    return Mosaic((tuple(pattern[:2]), tuple(pattern[2:])))


@every_pattern
def test_bilinear_is_theirs_within_the_border(pattern):
    raw = stream(1).random((20, 23))
    ours = demosaicked(raw, bilinear_filters(mosaic_of(pattern), ("R", "G", "B")))
    theirs = others.demosaicing_CFA_Bayer_bilinear(raw, pattern)
    np.testing.assert_allclose(ours[2:-2, 2:-2], theirs[2:-2, 2:-2], atol=1e-12)


@every_pattern
def test_malvar_is_theirs_within_the_border(pattern):
    raw = stream(2).random((20, 23))
    ours = demosaicked(raw, malvar_filters(mosaic_of(pattern), ("R", "G", "B")))
    theirs = others.demosaicing_CFA_Bayer_Malvar2004(raw, pattern)
    np.testing.assert_allclose(ours[3:-3, 3:-3], theirs[3:-3, 3:-3], atol=1e-12)
