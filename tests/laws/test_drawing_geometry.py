"""What is drawn is true to scale: ellipses and planes."""

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from hypothesis.extra.numpy import arrays

from chromanoise.geometry import ellipse_outline, plane_view

numbers = st.floats(-10.0, 10.0)


@given(
    arrays(float, (2,), elements=numbers),
    arrays(float, (2, 2), elements=numbers),
    st.floats(0.1, 5.0),
)
def test_every_point_of_an_ellipse_is_as_many_sigmas_away(center, root, sigmas):
    covariance = root @ root.T + 0.1 * np.eye(2)
    outline = ellipse_outline(center, covariance, sigmas=sigmas, points=50)
    away = outline - center
    mahalanobis = np.sqrt((away * np.linalg.solve(covariance, away.T).T).sum(axis=1))
    assert mahalanobis == pytest.approx(np.full(50, sigmas), rel=1e-6)
    assert outline[0] == pytest.approx(outline[-1], abs=1e-9 * (1 + np.abs(outline).max()))


@given(arrays(float, (2, 2), elements=numbers))
def test_an_ellipse_reaches_as_far_along_each_axis_as_its_standard_deviation(root):
    covariance = root @ root.T + 0.1 * np.eye(2)
    outline = ellipse_outline(np.zeros(2), covariance, sigmas=1.0, points=2001)
    assert outline.max(axis=0) == pytest.approx(np.sqrt(np.diagonal(covariance)), rel=1e-4)


def test_the_area_of_a_one_sigma_ellipse_is_pi_times_the_root_of_the_determinant():
    outline = ellipse_outline(
        np.array([3.0, -1.0]), np.array([[5.0, 3.0], [3.0, 2.0]]), sigmas=1.0, points=4001
    )
    x, y = outline.T
    shoelace = 0.5 * abs((x[:-1] * y[1:] - x[1:] * y[:-1]).sum())
    assert shoelace == pytest.approx(np.pi, rel=1e-5)  # det = 5 * 2 - 3 * 3 = 1


spectra = arrays(float, (7,), elements=st.floats(0.0, 1.0))


@given(spectra, spectra)
def test_a_plane_keeps_lengths_and_angles(first, second):
    gram = np.array([[first @ first, first @ second], [second @ first, second @ second]])
    assume(np.linalg.det(gram) > 1e-6 * (1e-3 + gram[0, 0] * gram[1, 1]))
    view = plane_view(first, second)
    assert view.axes.T @ view.axes == pytest.approx(np.eye(2), abs=1e-12)
    assert view.vectors.T @ view.vectors == pytest.approx(gram, rel=1e-9, abs=1e-12)
    assert view.vectors[1, 0] == pytest.approx(0.0, abs=1e-12)  # the first lies to the right
    assert view.vectors[0, 0] > 0
    assert view.vectors[1, 1] > 0  # the second points upward


@given(spectra, spectra, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0))
def test_light_in_the_plane_is_seen_at_full_length_and_the_rest_never_longer(a, b, s, t):
    gram = np.array([[a @ a, a @ b], [b @ a, b @ b]])
    determinant = gram[0, 0] * gram[1, 1] - gram[0, 1] ** 2
    assume(determinant > 1e-6 * (1e-3 + gram[0, 0] * gram[1, 1]))
    view = plane_view(a, b)
    inside = s * a + t * b
    assert view.seen(inside) == pytest.approx(view.vectors @ np.array([s, t]), abs=1e-9)
    other = np.arange(7.0) - 2
    assert np.linalg.norm(view.seen(other)) <= np.linalg.norm(other) * (1 + 1e-12)


def test_a_right_angle_of_3_and_4_is_drawn_with_a_hypotenuse_of_5():
    view = plane_view(np.array([0.0, 3.0, 0.0]), np.array([0.0, 0.0, 4.0]))
    assert np.linalg.norm(view.vectors[:, 0] - view.vectors[:, 1]) == pytest.approx(5.0, rel=1e-15)


@pytest.mark.parametrize("angle_deg", [0.001, 30.0, 120.0])
def test_a_planted_angle_is_drawn_as_it_is(angle_deg):
    t = np.radians(angle_deg)
    view = plane_view(np.array([2.0, 0.0, 0.0]), np.array([np.cos(t), np.sin(t), 0.0]))
    x, y = view.vectors[:, 1]
    assert np.degrees(np.arctan2(y, x)) == pytest.approx(angle_deg, rel=1e-9)
