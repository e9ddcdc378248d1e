"""Surface estimation, compared with surfaces that are known in closed form."""

import numpy as np
import pytest

from symjax.datasets import add_noise, generate
from symjax.datasets.sample import random_orthogonal
from symjax.robust.surface import NUM_NEIGHBOURS, estimate_surface


def on_sphere(rng, count):
    points = rng.normal(size=(count, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def sheet(rng, count, noise=0.0):
    """Returns points of a unit square, with noise along its normal."""
    return np.c_[rng.uniform(size=(count, 2)), noise * rng.normal(size=count)]


def degrees(a, b):
    return np.degrees(np.arccos(np.clip(np.abs((a * b).sum(axis=1)), 0, 1)))


@pytest.mark.parametrize("radii", [(1.0, 1.0, 1.0), (1.0, 0.7, 0.5)])
def test_normals_of_an_ellipsoid_are_those_of_its_gradient(rng, radii):
    unit = on_sphere(rng, 3_000)
    truth = unit / np.array(radii)
    truth /= np.linalg.norm(truth, axis=1, keepdims=True)
    found = estimate_surface(unit * np.array(radii))
    off = degrees(found.normals, truth)
    assert np.median(off) < 1.5
    assert np.quantile(off, 0.95) < 5.0
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1.0, rtol=1e-12)


def test_more_points_give_better_normals(rng):
    few, many = (
        np.median(degrees(estimate_surface(p).normals, p)) for p in (on_sphere(rng, 800), on_sphere(rng, 6_400))
    )
    # the error is proportional to the spacing
    assert many < 0.6 * few


@pytest.mark.parametrize("scale", [1e-3, 1.0, 50.0])
def test_spacing_is_the_side_of_a_points_own_square(rng, scale):
    found = estimate_surface(scale * sheet(rng, 3_000))
    np.testing.assert_allclose(found.spacing, scale / np.sqrt(3_000), rtol=0.06)
    found = estimate_surface(scale * on_sphere(rng, 2_000))
    np.testing.assert_allclose(found.spacing, scale * np.sqrt(4 * np.pi / 2_000), rtol=0.1)


def test_a_flat_sheet_has_no_thickness_and_full_confidence(rng):
    found = estimate_surface(sheet(rng, 1_000))
    assert found.thickness < 1e-12
    assert not found.noisy
    np.testing.assert_allclose(np.abs(found.normals), np.tile([0.0, 0.0, 1.0], (1_000, 1)), atol=1e-9)
    np.testing.assert_allclose(found.confidence, 1.0, atol=1e-9)


@pytest.mark.parametrize("noise", [0.006, 0.01, 0.015])
def test_the_thickness_of_a_noisy_sheet_is_its_noise(rng, noise):
    found = estimate_surface(sheet(rng, 3_000, noise))
    # the variance of 16 or more neighbours about their own best plane is biased low
    assert 0.7 < found.thickness / noise < 1.05
    assert estimate_surface(sheet(rng, 3_000, 0.01)).noisy


def test_thickness_grows_with_the_noise(rng):
    thickness = [estimate_surface(sheet(rng, 3_000, noise)).thickness for noise in (0.002, 0.004, 0.008, 0.016)]
    ratio = np.diff(np.log(thickness)) / np.log(2)
    assert (ratio > 0.75).all()


@pytest.mark.parametrize("kind", ["quadruped", "chair", "human", "teapot", "car"])
def test_noise_of_one_per_cent_is_noise_and_curvature_is_not(kind):
    points = generate(kind, num_points=2_500, rng=0).points
    assert not estimate_surface(points).noisy
    assert estimate_surface(add_noise(points, 0.01, 0)).noisy
    assert estimate_surface(add_noise(points, 0.02, 0)).noisy


def test_the_edge_of_a_hemisphere_is_its_boundary(rng):
    points = on_sphere(rng, 6_000)
    points = points[points[:, 2] > 0]
    boundary = estimate_surface(points).boundary
    assert boundary[points[:, 2] < 0.015].mean() > 0.9
    assert boundary[points[:, 2] > 0.2].mean() < 0.02


def test_the_edges_of_a_square_and_of_its_hole_are_the_boundary(rng):
    points = sheet(rng, 4_000)
    radius = np.linalg.norm(points[:, :2] - 0.5, axis=1)
    points, radius = points[radius > 0.2], radius[radius > 0.2]
    border = np.minimum(points[:, :2], 1 - points[:, :2]).min(axis=1)
    boundary = estimate_surface(points).boundary
    assert boundary[border < 0.01].mean() > 0.9
    assert boundary[radius < 0.21].mean() > 0.8
    assert boundary[(border > 0.08) & (radius > 0.28)].mean() < 0.02


def test_a_closed_surface_has_almost_no_boundary(rng):
    assert estimate_surface(on_sphere(rng, 2_000)).boundary.mean() < 0.01


def test_confidence_is_low_for_outliers_and_high_on_the_surface(rng):
    outliers = rng.uniform(-1, 1, size=(200, 3))
    outliers = outliers[np.abs(np.linalg.norm(outliers, axis=1) - 1) > 0.2]
    confidence = estimate_surface(np.vstack([on_sphere(rng, 2_000), outliers])).confidence
    assert np.quantile(confidence[:2_000], 0.05) > 0.9
    assert np.median(confidence[2_000:]) < 0.1
    assert np.quantile(confidence[2_000:], 0.95) < 0.4
    assert confidence.min() >= 0
    assert confidence.max() <= 1


def test_outliers_hardly_turn_the_normals_beside_them(rng):
    points, outliers = on_sphere(rng, 2_000), on_sphere(rng, 400)
    outliers *= 1 + rng.uniform(0.03, 0.3, size=(400, 1))
    found = estimate_surface(np.vstack([points, outliers]))
    off = degrees(found.normals[:2_000], points)
    assert np.median(off) < 2
    assert np.quantile(off, 0.9) < 5


def test_given_normals_are_used_whatever_their_length_and_orientation(rng):
    points = on_sphere(rng, 1_000)
    wrong = on_sphere(rng, 1_000)
    right = estimate_surface(points, normals=points)
    np.testing.assert_allclose(right.normals, points, atol=1e-12)
    factor = rng.choice([-1, 1], 1_000) * rng.uniform(0.1, 10, 1_000)
    other = estimate_surface(points, normals=factor[:, None] * points)
    np.testing.assert_allclose(other.normals, np.sign(factor)[:, None] * points, atol=1e-12)
    np.testing.assert_allclose(other.confidence, right.confidence, atol=1e-12)
    np.testing.assert_array_equal(other.boundary, right.boundary)
    assert np.median(estimate_surface(points, normals=wrong).confidence) < 0.5 < np.median(right.confidence)


def test_the_surface_is_equivariant_under_similarities(rng):
    points = generate("quadruped", num_points=1_500, rng=0).points
    turn = random_orthogonal(rng)
    one, other = estimate_surface(points), estimate_surface(7 * points @ turn.T + 3)
    assert np.quantile(degrees(one.normals @ turn.T, other.normals), 0.99) < 1e-3
    np.testing.assert_allclose(other.confidence, one.confidence, atol=1e-6)
    np.testing.assert_allclose([other.spacing, other.thickness], [7 * one.spacing, 7 * one.thickness], rtol=1e-9)
    assert np.mean(one.boundary != other.boundary) < 0.002
    np.testing.assert_allclose(other.tolerance, 7 * one.tolerance, rtol=1e-9)


def test_the_tolerance_is_half_a_spacing_or_the_noise(rng):
    clean, rough = estimate_surface(sheet(rng, 1_000)), estimate_surface(sheet(rng, 1_000, 0.05))
    assert clean.tolerance == pytest.approx(0.5 * clean.spacing)
    assert rough.tolerance == pytest.approx(1.5 * rough.thickness)


def test_fewer_points_than_neighbours_work(rng):
    points = sheet(rng, 20)
    assert len(points) < NUM_NEIGHBOURS
    found = estimate_surface(points)
    np.testing.assert_allclose(np.abs(found.normals[:, 2]), 1.0, atol=1e-6)
    assert found.boundary.any()
