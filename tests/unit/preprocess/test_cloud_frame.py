"""The cloud frame does not depend on rotation, reflection, position and units, and the map back is its inverse."""

import numpy as np
import pytest

from symjax.errors import DegenerateCloudError
from symjax.geometry.similarity import Similarity
from symjax.preprocess.cloud_frame import to_cloud_frame


def skewed(rng, num=200):
    return rng.exponential(size=(num, 3)) * (3.0, 2.0, 1.0)


def test_the_frame_is_equivariant(rng):
    points = skewed(rng)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moved = Similarity(7.0, turn, np.array([10.0, -20.0, 5.0])).points(points)
    own = to_cloud_frame(points)
    np.testing.assert_allclose(to_cloud_frame(moved).points, own.points, atol=1e-12)
    np.testing.assert_allclose(to_cloud_frame(moved).to_given.points(own.points), moved, atol=1e-9)


def test_it_is_centred_uncorrelated_and_of_diagonal_1(rng):
    own = to_cloud_frame(skewed(rng)).points
    np.testing.assert_allclose(own.mean(axis=0), 0.0, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(np.ptp(own, axis=0)), 1.0)
    scatter = own.T @ own
    np.testing.assert_allclose(scatter, np.diag(np.diag(scatter)), atol=1e-12)
    assert (np.diff(np.diag(scatter)) < 0).all()
    assert ((own**3).sum(axis=0) > 0).all()


def test_the_rank_is_that_of_the_points(rng):
    cloud = skewed(rng)
    assert [to_cloud_frame(cloud * scale).rank for scale in ((1, 1, 1), (1, 1, 0), (1, 0, 0))] == [3, 2, 1]
    with pytest.raises(DegenerateCloudError, match="all 5 ends coincide"):
        to_cloud_frame(np.ones((5, 3)), "ends")


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_huge_and_tiny_coordinates_neither_overflow_nor_vanish(scale, rng):
    points = skewed(rng)
    np.testing.assert_allclose(to_cloud_frame(scale * points).points, to_cloud_frame(points).points, atol=1e-12)
