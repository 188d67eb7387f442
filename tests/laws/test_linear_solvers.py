"""Solvers get only finite numbers: LAPACK may never return for an infinite one."""

import numpy as np
import pytest

from chromanoise.base import linalg as _linalg
from outcomes import refused_input

ONE = ("cholesky", "eigh", "eigvalsh", "inv", "matrix_rank", "pinv", "qr", "svd")
TWO = ("lstsq", "solve")


@pytest.mark.parametrize("name", [*ONE, *TWO])
@pytest.mark.parametrize("bad", [np.inf, -np.inf, np.nan])
def test_a_number_that_is_not_finite_is_refused_with_the_name_of_its_matrix(name, bad):
    matrix = np.array([[2.0, 0.0], [0.0, bad]])
    arrays = [matrix] if name in ONE else [np.eye(2), matrix]
    with refused_input(subject="the matrix of a camera", requirement="finite"):
        getattr(_linalg, name)("the matrix of a camera", *arrays)


def test_a_matrix_without_a_solution_is_refused_with_its_name():
    with refused_input(subject="a singular matrix", value=None):
        _linalg.inv("a singular matrix", np.zeros((2, 2)))


def test_finite_numbers_are_solved():
    matrix = np.array([[2.0, 1.0], [1.0, 3.0]])  # 2 x + y = 5, x + 3 y = 10: x = 1, y = 3
    sides = np.array([5.0, 10.0])
    np.testing.assert_allclose(_linalg.solve("two equations", matrix, sides), [1, 3], rtol=1e-14)
    best = _linalg.lstsq("two equations", matrix, sides, rcond=None)[0]
    np.testing.assert_allclose(best, [1, 3], rtol=1e-14)


def test_covariances_go_through_a_matrix_as_the_sums_of_its_entries():
    a, roots = (np.random.default_rng(7).normal(size=shape) for shape in ((3, 4), (2, 5, 4, 4)))
    covariances = roots @ np.swapaxes(roots, -1, -2)
    sums = np.einsum("ia,...ab,jb->...ij", a, covariances, a)
    for found in (_linalg.congruence, _linalg.congruence_of_many):
        np.testing.assert_allclose(found(a, covariances), sums, rtol=1e-12, atol=1e-12)
    variances = np.diagonal(sums, axis1=-2, axis2=-1)
    np.testing.assert_allclose(_linalg.variances_along(a, covariances), variances, rtol=1e-12)
