"""The last digits of a plane, and whether its standard errors are the errors that it has."""

import jax
import numpy as np
import pytest

from symjax.datasets import add_noise, build, generate
from symjax.datasets.solids.surface import sample_surface
from symjax.geometry.plane import Plane
from symjax.robust import quadrics as quadrics
from symjax.robust.quadrics import patches
from symjax.robust.refinement import SIGMA_FACTOR, Residuals, _clusters, clustered_covariance, heights, polish
from symjax.robust.surface import surface

TRUE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))


def around_of(points):
    """Surface and patches, in units of the diagonal."""
    found = surface(points / np.linalg.norm(np.ptp(points, axis=0)))
    return found, patches(found)


def turned(degrees, direction, shift=0.0):
    angle = np.radians(degrees)
    across = np.array([0.0, np.cos(direction), np.sin(direction)])
    return Plane(np.cos(angle) * TRUE.normal + np.sin(angle) * across, np.float64(shift))


@pytest.fixture(scope="module")
def animal():
    return around_of(generate("quadruped", num_points=2_000, rng=2).points)


def some_residuals(around, rng, count=50):
    found, local = around
    partner = rng.integers(len(found.points), size=count)
    rows = rng.integers(len(found.points), size=count)
    weight = rng.uniform(size=count)
    return Residuals(found.points[rows], *(leaf[partner] for leaf in local[:3]), weight), partner


@pytest.mark.parametrize("kind", ["quadruped", "human", "fish", "head", "block", "chair"])
def test_a_plane_that_is_1_degree_off_returns_to_the_truth(kind):
    around = around_of(generate(kind, num_points=2_000, rng=0).points)
    for direction, shift in ((0.5, 0.005), (3.0, -0.005)):
        found = polish(turned(1.0, direction, shift), *around)
        assert found.plane.angle(TRUE) < 0.05
        assert abs(found.plane.offset) < 2e-4
        assert np.linalg.norm(found.plane.normal) == pytest.approx(1)


@pytest.mark.parametrize("kind", ["mug", "jug", "car"])
def test_what_a_nearly_round_or_boxy_body_leaves_open_its_standard_error_says(kind):
    found = polish(turned(1.0, 0.5, 0.005), *around_of(generate(kind, num_points=2_000, rng=0).points))
    claimed = np.degrees(np.sqrt(np.trace(found.covariance[:2, :2])))
    assert claimed > 0.03
    assert found.plane.angle(TRUE) < 3 * claimed


def test_the_answer_hardly_depends_on_the_start_where_a_round_part_is_large():
    around = around_of(generate("teapot", num_points=2_000, rng=0).points)
    one, other = (polish(turned(1.0, direction, shift), *around) for direction, shift in ((0.5, 0.005), (3.0, -0.005)))
    claimed = np.degrees(np.sqrt(np.trace(other.covariance[:2, :2])))
    assert one.plane.angle(other.plane) < 5 * claimed


def test_noise_costs_digits_and_no_more():
    points = generate("quadruped", num_points=2_000, rng=0).points
    found = polish(turned(1.0, 0.5, 0.005), *around_of(add_noise(points, 0.005, 1)))
    assert found.plane.angle(TRUE) < 0.4
    assert found.sigma > SIGMA_FACTOR * 0.002


def test_a_plane_and_its_opposite_are_polished_to_one(animal):
    plane = turned(1.0, 0.5, 0.003)
    one, other = polish(plane, *animal), polish(Plane(-plane.normal, -plane.offset), *animal)
    assert one.plane.angle(other.plane) < 1e-3
    assert one.plane.offset == pytest.approx(-other.plane.offset, abs=1e-6)
    np.testing.assert_allclose(*(np.trace(p.covariance[:2, :2]) for p in (one, other)), rtol=0.05)


def test_polishing_again_changes_little(animal):
    once = polish(turned(1.0, 0.5), *animal)
    twice = polish(once.plane, *animal)
    assert once.plane.angle(twice.plane) < 3 * np.degrees(np.sqrt(np.trace(once.covariance[:2, :2])))


def test_heights_are_those_of_the_patches(animal, rng):
    data, partner = some_residuals(animal, rng)
    plane = turned(20, 1.0, 0.03)
    found = jax.jit(heights)(np.append(plane.normal, plane.offset), data)
    expected = quadrics.heights(np.asarray(plane.reflect(data.x)), animal[1], partner)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_the_derivative_of_the_heights_is_right(animal, rng):
    data, _ = some_residuals(animal, rng)
    plane = turned(20, 1.0, 0.03)
    z = np.append(plane.normal, plane.offset)
    step = 1e-6 * np.eye(4)
    at = jax.jit(heights)
    expected = np.stack([(at(z + h, data) - at(z - h, data)) / 2e-6 for h in step], axis=1)
    np.testing.assert_allclose(jax.jit(jax.jacfwd(heights))(z, data), expected, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(jax.jit(jax.jacrev(heights))(z, data), expected, rtol=1e-5, atol=1e-6)


def test_the_covariance_is_symmetric_and_positive(animal):
    found = polish(turned(1.0, 0.5), *animal)
    np.testing.assert_allclose(found.covariance, found.covariance.T, rtol=1e-6)
    assert np.linalg.eigvalsh(found.covariance).min() > 0
    np.testing.assert_allclose(found.tangents @ found.tangents.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(found.tangents @ found.plane.normal, 0, atol=1e-12)


@pytest.mark.parametrize("kind", ["quadruped", "chair"])
def test_standard_errors_are_the_scatter_over_new_samples(kind):
    solid = build(kind, 0)
    turns, shifts, claimed, distance = [], [], [], []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        points = sample_surface(solid.field, 1_500, rng)
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        found = polish(TRUE, *around_of(points + rng.normal(scale=0.004 * diagonal, size=points.shape)))
        turns.append(np.radians(found.plane.angle(TRUE)))
        shifts.append(found.plane.offset)
        claimed.append([np.trace(found.covariance[:2, :2]), found.covariance[2, 2]])
        step = np.append(found.tangents @ TRUE.normal, -found.plane.offset)
        distance.append(step @ np.linalg.solve(found.covariance, step))
    normal, offset = np.sqrt(np.mean(claimed, axis=0))
    assert 0.5 < np.sqrt(np.mean(np.square(turns))) / normal < 2
    assert 0.5 < np.sqrt(np.mean(np.square(shifts))) / offset < 2
    # χ² of three degrees: 3 on the mean, 7.8 with probability 0.95
    assert 1 < np.mean(distance) < 6
    assert np.mean(np.array(distance) < 7.815) > 0.8


def covariance_of(rows, residual, cluster):
    """Of plain least squares, whose gradients and Hessians are these."""
    return clustered_covariance(residual[:, None] * rows, rows[:, :, None] * rows[:, None], cluster)


def least_squares(rng, count):
    """Rows of a linear fit with three coefficients, its right-hand side, and the residuals at the optimum."""
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


def test_the_covariance_is_the_usual_one_where_all_noise_is_alike(rng):
    rows = rng.normal(size=(20_000, 3)) * [1.0, 2.0, 0.5]
    noise = 0.3 * rng.normal(size=20_000)
    found = covariance_of(rows, noise, np.arange(20_000))
    usual = 0.3**2 * np.linalg.inv(rows.T @ rows)
    np.testing.assert_allclose(found, usual, atol=0.05 * np.abs(usual).max())


def test_the_same_evidence_twice_is_no_more_evidence(rng):
    rows, _, residual = least_squares(rng, 200)
    twice = np.repeat(rows, 2, axis=0), np.repeat(residual, 2)
    once = covariance_of(rows, residual, np.arange(200))
    together = covariance_of(*twice, np.repeat(np.arange(200), 2))
    np.testing.assert_allclose(together, once, rtol=1e-9)
    # held for independent, it would seem half as uncertain
    np.testing.assert_allclose(np.trace(covariance_of(*twice, np.arange(400))), np.trace(once) / 2, rtol=0.05)


def test_a_point_and_its_mirror_image_share_a_cluster(rng):
    points = rng.uniform(-1, 1, size=(300, 3))
    plane = turned(33, 0.7, 0.1)
    cluster = _clusters(plane, np.vstack([points, np.asarray(plane.reflect(points))]), 0.2)
    np.testing.assert_array_equal(cluster[:300], cluster[300:])
    # two of the side that is not folded are together only within a cell
    above = np.asarray(plane.signed_distance(points)) > 0
    cells = [points[above & (cluster[:300] == c)] for c in np.unique(cluster[:300][above])]
    assert len(cells) > 50
    assert max(np.ptp(cell, axis=0).max() for cell in cells) <= 0.2
