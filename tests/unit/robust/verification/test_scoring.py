"""Scores and exactness: high for the true plane, low for a wrong one, zero for one far away."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from symjax.datasets import add_noise, generate
from symjax.geometry.plane import Plane
from symjax.robust.quadrics import fit_quadrics
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.scoring import HEIGHT_SCALE, SLACK, PlaneScore, exactness, score_plane
from symjax.robust.voxel_grid import penalty_at, voxel_grid

TRUE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))


def surface_and_grid(points):
    """Returns surface and voxel grid of a cloud, in units of its diagonal."""
    found = estimate_surface(points / np.linalg.norm(np.ptp(points, axis=0)))
    return found, voxel_grid(found, None, boundary_penalty=0.15)


@pytest.fixture(scope="module")
def exact_sample():
    """A cloud whose points all have an exact mirror image in it."""
    half = generate("quadruped", num_points=2_400, rng=0).points
    half = half[half[:, 0] > 0]
    return surface_and_grid(np.concatenate([half, half * [-1, 1, 1]]))


@pytest.fixture(scope="module")
def random_sample():
    """Random points of a symmetric object: none has an exact mirror image among them."""
    return surface_and_grid(generate("quadruped", num_points=2_000, rng=0).points)


def turned(degrees, shift=0.0):
    angle = np.radians(degrees)
    return Plane(np.array([np.cos(angle), 0.6 * np.sin(angle), 0.8 * np.sin(angle)]), np.float64(shift))


def test_every_point_agrees_with_its_exact_mirror_image(exact_sample):
    found = score_plane(TRUE, *exact_sample)
    points = exact_sample[0].points
    np.testing.assert_allclose(points[found.partner], points * [-1, 1, 1], atol=1e-12)
    np.testing.assert_array_equal(found.partner[found.partner], np.arange(len(points)))
    assert found.score > 0.99
    assert np.median(found.agreement) > 0.999


def test_a_wrong_plane_scores_low(exact_sample, random_sample):
    for around in (exact_sample, random_sample):
        true = score_plane(TRUE, *around).score
        assert true > 0.85
        for plane in (turned(30), turned(90), Plane(TRUE.normal, np.float64(0.1))):
            assert score_plane(plane, *around).score < 0.6 * true


def test_the_score_falls_as_the_plane_leaves_the_truth(random_sample):
    by_angle = [score_plane(turned(angle), *random_sample).score for angle in (0, 2, 5, 15)]
    by_shift = [score_plane(turned(0, shift), *random_sample).score for shift in (0, 0.005, 0.02, 0.05)]
    assert (np.diff(by_angle) < 0).all()
    assert (np.diff(by_shift) < 0).all()


def test_a_plane_far_away_scores_zero(random_sample):
    found = score_plane(Plane(TRUE.normal, np.float64(10.0)), *random_sample)
    assert found.score < 1e-9
    assert found.weight.min() > 0


@pytest.mark.parametrize("degrees", [0, 20, 70])
def test_both_orientations_of_a_plane_have_the_same_score(random_sample, degrees):
    plane = turned(degrees, 0.03)
    one, other = (score_plane(p, *random_sample) for p in (plane, Plane(-plane.normal, -plane.offset)))
    np.testing.assert_array_equal(one.partner, other.partner)
    np.testing.assert_allclose(other.agreement, one.agreement, rtol=1e-12)
    assert other.score == pytest.approx(one.score, rel=1e-12)


def test_the_partner_is_the_nearest_neighbour_of_the_mirror_image(random_sample):
    around, grid = random_sample
    plane = turned(10, 0.02)
    image = np.asarray(plane.reflect(around.points))
    found = score_plane(plane, around, grid)
    np.testing.assert_array_equal(found.partner, cKDTree(around.points).query(image)[1])
    np.testing.assert_array_equal(found.penalty, penalty_at(grid, image))
    assert found.agreement.min() >= 0
    assert found.agreement.max() <= 1
    assert (found.weight <= around.confidence + 1e-12).all()


def test_the_agreement_falls_with_height_distance_and_angle_between_normals(rng):
    # a flat sheet at x = 1, and points at x < 0 whose mirror images are lifted, tilted or shifted by known amounts
    sheet = np.c_[np.ones(400), rng.uniform(-1, 1, size=(400, 2))]
    lift, tilt = np.array([0.0, 0.02, 0.0, 0.0]), np.radians([0, 0, 40, 0])
    beside = np.array([0.0, 0.0, 0.0, 1.0])
    probes = np.stack([-1 - lift, np.array([0.0, 0.1, -0.2, 0.9]) + beside, np.zeros(4)], axis=1)
    normals = np.r_[np.tile([[1.0, 0.0, 0.0]], (400, 1)), np.stack([np.cos(tilt), np.sin(tilt), 0 * tilt], axis=1)]
    around = estimate_surface(np.vstack([sheet, probes]), normals=normals)
    found = score_plane(TRUE, around, voxel_grid(around, None, boundary_penalty=0.15), np.arange(400, 404))
    image = probes * [-1, 1, 1]
    off = image - around.points[found.partner]
    along = np.linalg.norm(off[:, 1:], axis=1)
    expected = np.exp(-0.5 * (off[:, 0] / (HEIGHT_SCALE * around.tolerance)) ** 2)
    expected *= np.exp(-0.5 * np.maximum(along / around.spacing - SLACK, 0) ** 2) * np.cos(tilt) ** 2
    np.testing.assert_allclose(found.agreement, expected, rtol=1e-6, atol=1e-9)
    assert found.agreement[0] > 0.99
    assert (found.agreement[1:] < 0.97).all()


def test_points_on_the_plane_have_no_weight(random_sample):
    around, _ = random_sample
    height = np.abs(around.points[:, 0])
    weight = score_plane(TRUE, *random_sample).weight / around.confidence
    assert weight[height < 0.1 * around.spacing].max() < 0.01
    assert weight[height > 4 * around.spacing].min() > 0.99


def test_some_rows_have_the_same_agreement_as_among_all(random_sample):
    rows = np.arange(0, 2_000, 3)
    some, every = score_plane(turned(5), *random_sample, rows), score_plane(turned(5), *random_sample)
    for part, whole in zip(some, every, strict=True):
        np.testing.assert_allclose(part, whole[rows], rtol=1e-9, atol=1e-12)


def test_the_score_is_agreement_over_agreement_and_penalty():
    agreement, weight, penalty = np.array([1.0, 0.5, 0.0]), np.array([1.0, 2.0, 4.0]), np.array([1.0, 0.5, 0.25])
    found = PlaneScore(np.zeros(3, int), np.zeros(3), agreement, weight, penalty)
    assert found.score == pytest.approx(2.0 / (2.0 + 0.5 + 1.0))
    assert found.score_of(np.ones(3)) == pytest.approx(1)
    assert found.score_of(np.zeros(3)) == 0
    assert found._replace(weight=np.zeros(3)).score == 0
    # without a penalty, the score is 1 as soon as anything agrees
    assert found._replace(penalty=np.zeros(3)).score == pytest.approx(1)


def exactness_of(points, plane):
    around, grid = surface_and_grid(points)
    return exactness(plane, around, score_plane(plane, around, grid), fit_quadrics(around))


def test_exactness_is_high_for_an_exact_symmetry_whatever_the_noise():
    points = generate("quadruped", num_points=3_000, rng=0).points
    assert exactness_of(points, TRUE) > 0.55
    assert exactness_of(add_noise(points, 0.005, 1), TRUE) > 0.55
    assert exactness_of(add_noise(points, 0.01, 1), TRUE) > 0.55


@pytest.mark.parametrize("kind", ["tree", "hand", "scrap"])
def test_exactness_is_low_without_a_symmetry(kind):
    points = generate(kind, num_points=2_000, rng=0).points
    points = points - points.mean(axis=0)
    for normal in np.linalg.eigh(np.cov(points.T))[1].T:
        assert exactness_of(points, Plane(normal, np.float64(0.0))) < 0.35


def test_exactness_falls_by_an_offset_that_hardly_changes_the_score(random_sample):
    around, grid = random_sample
    local = fit_quadrics(around)
    exact, off = (score_plane(plane, around, grid) for plane in (TRUE, turned(0, 0.002)))
    assert off.score > 0.95 * exact.score
    assert exactness(turned(0, 0.002), around, off, local) < 0.6 * exactness(TRUE, around, exact, local)
