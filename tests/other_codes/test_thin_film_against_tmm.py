"""Thin films against `tmm`, the transfer-matrix code of S. Byrnes."""

import numpy as np
import tmm
from hypothesis import given, settings, strategies as st

from chromanoise.sensor.filter_models import cauchy_index, thin_film_stack
from chromanoise.spectra import Grid

GRID = Grid.uniform(400, 1050, 50)


@settings(max_examples=25)
@given(
    st.lists(st.tuples(st.floats(1.0, 500.0), st.floats(1.0, 4.0)), min_size=0, max_size=12),
    st.floats(1.0, 2.0),
    st.floats(1.0, 4.0),
)
def test_a_stack_transmits_what_tmm_computes(films, index_in, index_out):
    thickness = [nm for nm, _ in films]
    index = [cauchy_index(GRID, n, 0.01) for _, n in films]
    ours = thin_film_stack(
        GRID, thickness_nm=thickness, index=index, index_in=index_in, index_out=index_out
    )
    theirs = [
        tmm.coh_tmm(
            "s",
            [index_in, *(float(n[i]) for n in index), index_out],
            [np.inf, *thickness, np.inf],
            0.0,
            nm,
        )["T"]
        for i, nm in enumerate(GRID.wavelength_nm)
    ]
    np.testing.assert_allclose(ours, theirs, rtol=1e-9)
