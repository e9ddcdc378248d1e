"""Clustered covariance agrees with textbook formulas in the cases that they cover."""

import numpy as np

from symjax.geometry.plane import Plane
from symjax.robust.covariance import clustered_covariance, mirror_clusters


def covariance_of(rows, residual, cluster):
    """Returns the clustered covariance of a linear least-squares fit."""
    return clustered_covariance(residual[:, None] * rows, rows[:, :, None] * rows[:, None], cluster)


def least_squares(rng, count):
    """Returns the rows of a linear fit with three coefficients, the values, and the residuals at the optimum."""
    rows = rng.normal(size=(count, 3)) * [1.0, 2.0, 0.5]
    values = rng.normal(size=count) * rng.uniform(0.1, 1.0, count)
    return rows, values, values - rows @ np.linalg.lstsq(rows, values, rcond=None)[0]


def test_singleton_clusters_of_plain_least_squares_give_the_textbook_sandwich(rng):
    rows, _, residual = least_squares(rng, 200)
    inverse = np.linalg.inv(rows.T @ rows)
    leverage = ((rows @ inverse) * rows).sum(axis=1)
    # HC3 of MacKinnon and White (1985)
    textbook = inverse @ (rows.T * (residual / (1 - leverage)) ** 2) @ rows @ inverse * (1 - 1 / 200)
    found = covariance_of(rows, residual, np.arange(200))
    np.testing.assert_allclose(found, textbook, rtol=1e-9)


def test_clusters_are_left_out_one_by_one(rng):
    rows, values, residual = least_squares(rng, 120)
    cluster = rng.integers(10, size=120)
    whole = np.linalg.lstsq(rows, values, rcond=None)[0]
    without = [np.linalg.lstsq(rows[cluster != c], values[cluster != c], rcond=None)[0] - whole for c in range(10)]
    jackknife = np.einsum("ci,cj->ij", without, without) * (1 - 1 / 10)
    np.testing.assert_allclose(covariance_of(rows, residual, cluster), jackknife, rtol=1e-9)


def test_the_covariance_is_the_usual_one_for_homoscedastic_noise(rng):
    rows = rng.normal(size=(20_000, 3)) * [1.0, 2.0, 0.5]
    noise = 0.3 * rng.normal(size=20_000)
    found = covariance_of(rows, noise, np.arange(20_000))
    usual = 0.3**2 * np.linalg.inv(rows.T @ rows)
    np.testing.assert_allclose(found, usual, atol=0.05 * np.abs(usual).max())


def test_repeated_residuals_do_not_reduce_the_covariance(rng):
    rows, _, residual = least_squares(rng, 200)
    twice = np.repeat(rows, 2, axis=0), np.repeat(residual, 2)
    once = covariance_of(rows, residual, np.arange(200))
    together = covariance_of(*twice, np.repeat(np.arange(200), 2))
    np.testing.assert_allclose(together, once, rtol=1e-9)
    # if the copies were treated as independent, the variance would be halved
    np.testing.assert_allclose(np.trace(covariance_of(*twice, np.arange(400))), np.trace(once) / 2, rtol=0.05)


def test_a_point_and_its_mirror_image_share_a_cluster(rng):
    points = rng.uniform(-1, 1, size=(300, 3))
    plane = Plane(np.array([0.84, 0.42, 0.34]) / np.linalg.norm([0.84, 0.42, 0.34]), np.float64(0.1))
    cluster = mirror_clusters(plane, np.vstack([points, np.asarray(plane.reflect(points))]), 0.2)
    np.testing.assert_array_equal(cluster[:300], cluster[300:])
    # on the side that is not folded, points of one cluster lie in one cell
    above = np.asarray(plane.signed_distance(points)) > 0
    cells = [points[above & (cluster[:300] == c)] for c in np.unique(cluster[:300][above])]
    assert len(cells) > 50
    assert max(np.ptp(cell, axis=0).max() for cell in cells) <= 0.2
