"""Refinement reaches the true plane, and its standard errors predict the actual errors."""

import jax
import numpy as np
import pytest

from symjax.datasets import add_noise, build, generate
from symjax.datasets.solids.surface import sample_surface
from symjax.geometry.plane import Plane
from symjax.robust.quadrics import fit_quadrics
from symjax.robust.refinement import SIGMA_FACTOR, Correspondences, heights, refine
from symjax.robust.surface import estimate_surface

TRUE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))


def surface_and_quadrics(points):
    """Returns surface and quadrics of a cloud, in units of its diagonal."""
    found = estimate_surface(points / np.linalg.norm(np.ptp(points, axis=0)))
    return found, fit_quadrics(found)


def turned(degrees, direction, shift=0.0):
    angle = np.radians(degrees)
    across = np.array([0.0, np.cos(direction), np.sin(direction)])
    return Plane(np.cos(angle) * TRUE.normal + np.sin(angle) * across, np.float64(shift))


@pytest.fixture(scope="module")
def animal():
    return surface_and_quadrics(generate("quadruped", num_points=2_000, rng=2).points)


def random_correspondences(around, rng, count=50):
    found, local = around
    partner = rng.integers(len(found.points), size=count)
    rows = rng.integers(len(found.points), size=count)
    weight = rng.uniform(size=count)
    return Correspondences(found.points[rows], local.frames_of(partner), local.coefficients[partner], weight), partner


@pytest.mark.parametrize("kind", ["quadruped", "human", "fish", "head", "block", "chair"])
def test_a_plane_that_is_off_by_1_degree_returns_to_the_truth(kind):
    around = surface_and_quadrics(generate(kind, num_points=2_000, rng=0).points)
    for direction, shift in ((0.5, 0.005), (3.0, -0.005)):
        found = refine(turned(1.0, direction, shift), *around)
        assert found.plane.angle(TRUE) < 0.05
        assert abs(found.plane.offset) < 2e-4
        assert np.linalg.norm(found.plane.normal) == pytest.approx(1)


@pytest.mark.parametrize("kind", ["mug", "jug", "car"])
def test_the_error_on_a_nearly_round_or_boxy_body_is_within_three_standard_errors(kind):
    found = refine(turned(1.0, 0.5, 0.005), *surface_and_quadrics(generate(kind, num_points=2_000, rng=0).points))
    claimed = found.uncertainty.normal_degrees
    assert claimed > 0.03
    assert found.plane.angle(TRUE) < 3 * claimed


def test_the_result_hardly_depends_on_the_start_although_a_round_part_is_large():
    around = surface_and_quadrics(generate("teapot", num_points=2_000, rng=0).points)
    one, other = (refine(turned(1.0, direction, shift), *around) for direction, shift in ((0.5, 0.005), (3.0, -0.005)))
    claimed = other.uncertainty.normal_degrees
    assert one.plane.angle(other.plane) < 5 * claimed


def test_noise_reduces_the_accuracy_only_moderately():
    points = generate("quadruped", num_points=2_000, rng=0).points
    found = refine(turned(1.0, 0.5, 0.005), *surface_and_quadrics(add_noise(points, 0.005, 1)))
    assert found.plane.angle(TRUE) < 0.4
    assert found.sigma > SIGMA_FACTOR * 0.002


def test_both_orientations_of_a_plane_are_refined_to_the_same_plane(animal):
    plane = turned(1.0, 0.5, 0.003)
    one, other = refine(plane, *animal), refine(Plane(-plane.normal, -plane.offset), *animal)
    assert one.plane.angle(other.plane) < 1e-3
    assert one.plane.offset == pytest.approx(-other.plane.offset, abs=1e-6)
    np.testing.assert_allclose(*(np.trace(p.uncertainty.covariance[:2, :2]) for p in (one, other)), rtol=0.05)


def test_refining_again_changes_little(animal):
    once = refine(turned(1.0, 0.5), *animal)
    twice = refine(once.plane, *animal)
    assert once.plane.angle(twice.plane) < 3 * once.uncertainty.normal_degrees


def test_heights_are_those_of_the_quadrics(animal, rng):
    data, partner = random_correspondences(animal, rng)
    plane = turned(20, 1.0, 0.03)
    found = jax.jit(heights)(np.append(plane.normal, plane.offset), data)
    expected = animal[1].heights(np.asarray(plane.reflect(data.x)), partner)
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_derivatives_of_the_heights_equal_finite_differences(animal, rng):
    data, _ = random_correspondences(animal, rng)
    plane = turned(20, 1.0, 0.03)
    z = np.append(plane.normal, plane.offset)
    step = 1e-6 * np.eye(4)
    at = jax.jit(heights)
    expected = np.stack([(at(z + h, data) - at(z - h, data)) / 2e-6 for h in step], axis=1)
    np.testing.assert_allclose(jax.jit(jax.jacfwd(heights))(z, data), expected, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(jax.jit(jax.jacrev(heights))(z, data), expected, rtol=1e-5, atol=1e-6)


def test_the_covariance_is_symmetric_and_positive_definite(animal):
    found = refine(turned(1.0, 0.5), *animal)
    np.testing.assert_allclose(found.uncertainty.covariance, found.uncertainty.covariance.T, rtol=1e-6)
    assert np.linalg.eigvalsh(found.uncertainty.covariance).min() > 0
    np.testing.assert_allclose(found.uncertainty.tangents @ found.uncertainty.tangents.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(found.uncertainty.tangents @ found.plane.normal, 0, atol=1e-12)


@pytest.mark.parametrize("kind", ["quadruped", "chair"])
def test_standard_errors_agree_with_the_scatter_over_new_samples(kind):
    solid = build(kind, 0)
    turns, shifts, claimed, distance = [], [], [], []
    for seed in range(25):
        rng = np.random.default_rng(seed)
        points = sample_surface(solid.field, 1_500, rng)
        diagonal = np.linalg.norm(np.ptp(points, axis=0))
        found = refine(TRUE, *surface_and_quadrics(points + rng.normal(scale=0.004 * diagonal, size=points.shape)))
        turns.append(np.radians(found.plane.angle(TRUE)))
        shifts.append(found.plane.offset)
        claimed.append([np.trace(found.uncertainty.covariance[:2, :2]), found.uncertainty.covariance[2, 2]])
        step = np.append(found.uncertainty.tangents @ TRUE.normal, -found.plane.offset)
        distance.append(step @ np.linalg.solve(found.uncertainty.covariance, step))
    normal, offset = np.sqrt(np.mean(claimed, axis=0))
    assert 0.5 < np.sqrt(np.mean(np.square(turns))) / normal < 2
    assert 0.5 < np.sqrt(np.mean(np.square(shifts))) / offset < 2
    # χ² with three degrees of freedom: its mean is 3, its 95 % quantile 7.8
    assert 1 < np.mean(distance) < 6
    assert np.mean(np.array(distance) < 7.815) > 0.8
