"""Keypoints are at the corners and edges of a box, cover the cloud, and are equivariant."""

import numpy as np
from scipy.spatial import cKDTree

from symjax.symhks.keypoints import farthest_points, keypoints, shape_signatures


def box(rng, num_points=4_000):
    """Surface of a box of unit diagonal, whose corners are its only salient points."""
    points = rng.uniform(-1, 1, size=(num_points, 3))
    axis = rng.integers(3, size=num_points)
    points[np.arange(num_points), axis] = rng.choice([-1.0, 1.0], size=num_points)
    sides = np.array([1.0, 1.2, 1.5])
    return points * sides / (2 * np.linalg.norm(sides))


def test_shape_signatures_are_on_the_edges_of_a_box_and_at_all_its_corners(rng):
    points = box(rng)
    sides = np.abs(points).max(axis=0)
    corners = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T * sides
    found = points[shape_signatures(points, radius=0.1)]
    assert cKDTree(found).query(corners)[0].max() < 0.06
    at_side = (sides - np.abs(found[:50]) < 0.06).sum(axis=1)
    assert (at_side >= 2).all()


def test_keypoints_are_equivariant(rng):
    points = box(rng, 2_000)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    order = rng.permutation(len(points))
    there = keypoints(points, num_keypoints=200)
    back = keypoints((points @ turn.T)[order], num_keypoints=200)
    assert set(order[back.rows]) == set(there.rows)
    assert back.num_salient == there.num_salient > 0


def test_keypoints_cover_the_cloud_better_than_random_ones(rng):
    points = box(rng)
    found = keypoints(points, num_keypoints=200)
    assert len(set(found.rows)) == 200
    distance = cKDTree(points[found.rows]).query(points)[0]
    random = cKDTree(points[rng.choice(len(points), 200, replace=False)]).query(points)[0]
    assert distance.max() < 0.7 * random.max()


def test_each_farthest_point_is_the_farthest_from_those_before(rng):
    points = rng.normal(size=(300, 3))
    index = farthest_points(points, 20)
    for taken in range(1, 20):
        distance = cKDTree(points[index[:taken]]).query(points)[0]
        assert distance[index[taken]] == distance.max()


def test_all_of_a_few_points_are_keypoints_and_their_spacing_is_not_zero(rng):
    points = rng.normal(size=(60, 3))
    found = keypoints(points, num_keypoints=500)
    assert len(found.rows) == 60
    to_others = cKDTree(points).query(points, k=2)[0][:, 1]
    np.testing.assert_allclose(found.spacing, np.median(to_others), rtol=1e-12)
