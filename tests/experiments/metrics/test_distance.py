"""Distance of points from a mesh."""

import numpy as np
import pytest
from trimesh.triangles import closest_point

from experiments.metrics.distance import squared_distances
from symjax.errors import InvalidArgumentError
from symjax.io.mesh import Mesh
from tests.experiments.metrics.cubes import BOX


def test_distance_from_a_cube_by_hand():
    points = np.array([[0.0, 0, 0], [2.0, 0, 0], [0.1, 0.2, 0.9], [1.5, 1.5, 1.5], [0.5, 1.5, 0.25]])
    assert squared_distances(points, BOX) == pytest.approx([0.25, 2.25, 0.16, 3.0, 1.0])


@pytest.mark.parametrize("spread", [0.0, 3.0])
def test_distance_is_that_of_the_nearest_of_all_triangles(rng, spread):
    size = np.exp(spread * rng.normal(size=(400, 1, 1)))
    corners = rng.normal(size=(400, 1, 3)) + 0.1 * size * rng.normal(size=(400, 3, 3))
    points = 1.5 * rng.normal(size=(150, 3))
    soup = Mesh(corners.reshape(-1, 3), np.arange(1200).reshape(-1, 3), 400)
    pairs = closest_point(np.tile(corners, (150, 1, 1)), np.repeat(points, 400, axis=0)).reshape(150, 400, 3)
    least = ((pairs - points[:, None]) ** 2).sum(axis=2).min(axis=1)
    np.testing.assert_allclose(squared_distances(points, soup), least, rtol=1e-12, atol=1e-14)


def test_triangles_without_area_are_left_out():
    flat = np.array([[0, 0, 1], [0, 1, 0], [3, 3, 3]])
    points = np.array([[2.0, 0.1, 0.3]])
    assert squared_distances(points, BOX._replace(triangles=np.vstack([BOX.triangles, flat]))) == pytest.approx([2.25])
    with pytest.raises(InvalidArgumentError, match="without any area"):
        squared_distances(points, BOX._replace(triangles=flat))
