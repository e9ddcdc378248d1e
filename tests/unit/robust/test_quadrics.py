"""Quadrics: they reproduce quadric surfaces, have a cubic error on others, and estimate the noise."""

import numpy as np
import pytest

from symjax.datasets.sample import random_orthogonal
from symjax.robust.quadrics import CLEAN_NEIGHBOURS, NOISY_NEIGHBOURS, fit_quadrics
from symjax.robust.surface import estimate_surface


def quadric(rng, coefficients, count=800, size=1.0):
    """Returns points of z = c₃x² + c₄xy + c₅y² and their exact normals; the first point is the origin."""
    x, y = np.append(np.zeros((1, 2)), rng.uniform(-0.5, 0.5, size=(count - 1, 2)) * size, axis=0).T
    c3, c4, c5 = coefficients
    points = np.stack([x, y, c3 * x * x + c4 * x * y + c5 * y * y], axis=1)
    normals = np.stack([-2 * c3 * x - c4 * y, -c4 * x - 2 * c5 * y, np.ones_like(x)], axis=1)
    return points, normals


def waves(x, y):
    return 0.3 * np.sin(2 * x + 1) * np.cos(1.5 * y) + 0.2 * x * y


def axes_of(quadrics):
    """Returns the tangents u and w and the normal of every point, in rows."""
    return np.asarray(quadrics.frames.rotation)


def half_second_form(quadrics, row):
    """Returns half the second fundamental form of a quadric as a tensor in space."""
    c = quadrics.coefficients[row]
    u, w, _ = axes_of(quadrics)[row]
    return c[3] * np.outer(u, u) + 0.5 * c[4] * (np.outer(u, w) + np.outer(w, u)) + c[5] * np.outer(w, w)


@pytest.mark.parametrize("true", [(0.5, 0.0, 0.5), (0.8, 0.0, -0.8), (0.3, 0.6, -0.2), (0.0, 0.0, 0.0)])
def test_a_quadric_surface_is_reproduced(rng, true):
    points, normals = quadric(rng, true)
    quadrics = fit_quadrics(estimate_surface(points, normals=normals))
    expected = np.zeros((3, 3))
    expected[:2, :2] = [[true[0], true[1] / 2], [true[1] / 2, true[2]]]
    np.testing.assert_allclose(np.sign(axes_of(quadrics)[0, 2, 2]) * half_second_form(quadrics, 0), expected, atol=2e-3)
    np.testing.assert_allclose(quadrics.coefficients[0, :3], 0, atol=1e-4)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 200.0])
def test_quadrics_are_equivariant_under_rotation_and_scaling(rng, scale):
    points, normals = quadric(rng, (0.3, 0.6, -0.2))
    turn = random_orthogonal(rng)
    one = fit_quadrics(estimate_surface(points, normals=normals))
    other = fit_quadrics(estimate_surface(scale * points @ turn.T + scale, normals=normals @ turn.T))
    # curvature is an inverse length
    np.testing.assert_allclose(scale * half_second_form(other, 0), turn @ half_second_form(one, 0) @ turn.T, atol=3e-4)
    assert other.scatter == pytest.approx(scale * one.scatter, rel=1e-3)
    np.testing.assert_allclose(other.radius, scale * one.radius, rtol=1e-9)


def test_axes_are_orthonormal_and_the_third_is_the_normal(rng):
    points, normals = quadric(rng, (0.3, 0.6, -0.2), 200)
    found = estimate_surface(points, normals=normals)
    axes = axes_of(fit_quadrics(found))
    np.testing.assert_allclose(axes @ axes.transpose(0, 2, 1), np.tile(np.eye(3), (200, 1, 1)), atol=1e-12)
    np.testing.assert_array_equal(axes[:, 2], found.normals)


def error_between_points(rng, count):
    """Returns the median height of new surface points above the nearest points' quadrics, and the spacing."""
    xy = rng.uniform(-1, 1, size=(count, 2))
    found = estimate_surface(np.c_[xy, waves(*xy.T)])
    fresh = rng.uniform(-0.7, 0.7, size=(2_000, 2))
    fresh = np.c_[fresh, waves(*fresh.T)]
    return np.median(np.abs(fit_quadrics(found).heights(fresh, found.tree.query(fresh)[1]))), found.spacing


def test_the_error_is_proportional_to_the_cube_of_the_spacing(rng):
    coarse, fine = error_between_points(rng, 1_000), error_between_points(rng, 9_000)
    order = np.log(coarse[0] / fine[0]) / np.log(coarse[1] / fine[1])
    assert 2.5 < order < 4.0
    assert coarse[0] < 0.01 * coarse[1]


def test_heights_are_signed_distances_along_the_normal(rng):
    points, normals = quadric(rng, (0.3, 0.6, -0.2))
    found = estimate_surface(points, normals=normals)
    quadrics = fit_quadrics(found)
    rows = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) < 0.4)
    for lift in (-0.01, 0.02):
        np.testing.assert_allclose(quadrics.heights(points[rows] + lift * found.normals[rows], rows), lift, atol=2e-4)


def test_the_scatter_is_proportional_to_the_noise(rng):
    xy, error = rng.uniform(-1, 1, size=(3_000, 2)), rng.normal(size=3_000)
    levels = np.array([0.005, 0.01, 0.02])
    ratio = [
        fit_quadrics(estimate_surface(np.c_[xy, waves(*xy.T) + noise * error])).scatter / noise for noise in levels
    ]
    # it is less than the noise: six coefficients fitted to a dozen points follow a part of it
    assert np.sqrt(1 - 6 / 12) - 0.15 < min(ratio)
    assert max(ratio) < 1
    assert max(ratio) < 1.3 * min(ratio)


def test_a_clean_surface_has_almost_no_scatter(rng):
    xy = rng.uniform(-1, 1, size=(3_000, 2))
    found = estimate_surface(np.c_[xy, waves(*xy.T)])
    assert fit_quadrics(found).scatter < 0.01 * found.spacing


def test_quadrics_of_noisy_surfaces_have_more_neighbours(rng):
    xy = rng.uniform(-1, 1, size=(2_000, 2))
    clean, noisy = (estimate_surface(np.c_[xy, level * rng.normal(size=2_000)]) for level in (0.0, 0.05))
    assert (clean.noisy, noisy.noisy) == (False, True)
    for found, count in ((clean, CLEAN_NEIGHBOURS), (noisy, NOISY_NEIGHBOURS)):
        np.testing.assert_allclose(fit_quadrics(found).radius, found.tree.query(found.points, k=count + 1)[0][:, -1])


def test_outliers_hardly_change_the_quadrics(rng):
    points, _ = quadric(rng, (0.5, 0.0, 0.5))
    outliers = np.c_[rng.uniform(-0.5, 0.5, size=(80, 2)), rng.uniform(0.4, 1.5, 80)]
    alone, together = (
        fit_quadrics(estimate_surface(points)),
        fit_quadrics(estimate_surface(np.vstack([points, outliers]))),
    )
    inner = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) < 0.35)
    moved = together.heights(points[inner], inner) - alone.heights(points[inner], inner)
    assert np.median(np.abs(moved)) < 1e-3


def test_a_small_flat_cloud_has_quadrics(rng):
    flat = np.c_[rng.uniform(size=(12, 2)), np.zeros(12)]
    quadrics = fit_quadrics(estimate_surface(flat))
    assert np.isfinite(quadrics.coefficients).all()
    np.testing.assert_allclose(quadrics.heights(flat, np.arange(12)), 0, atol=1e-9)
    assert quadrics.scatter < 1e-9
