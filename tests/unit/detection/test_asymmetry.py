"""The asymmetry map is zero where the mirror image lies on the surface, and its signed height elsewhere."""

import numpy as np
import pytest

from symjax.detection.asymmetry import asymmetry
from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane

PLANE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))


def sphere(radius=1.0, num=4000):
    return radius * fibonacci(num, half=False)


@pytest.mark.parametrize("radius", [1.1, 0.9])
def test_the_height_of_a_point_off_a_sphere_is_that_of_its_image(radius):
    # the mirror image is as far from the sphere as the point: positive outside
    found = asymmetry(sphere(radius, 50), PLANE, sphere())
    np.testing.assert_allclose(found, radius - 1, atol=5e-3)


def test_a_symmetric_surface_has_no_asymmetry_and_a_shifted_plane_has_twice_the_shift():
    cloud = sphere()
    assert np.abs(asymmetry(cloud, PLANE, cloud)).max() < 5e-3
    poles = np.array([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
    found = asymmetry(poles, PLANE._replace(offset=np.float64(0.05)), cloud)
    np.testing.assert_allclose(found, [-0.1, 0.1], atol=5e-3)


def test_the_map_keeps_the_order_of_the_points_and_is_nan_where_they_are_not_finite():
    points = np.concatenate([sphere(1.1, 5), np.full((1, 3), np.nan), sphere(0.9, 5)])
    found = asymmetry(points, PLANE, sphere())
    assert np.flatnonzero(np.isnan(found)).tolist() == [5]
    assert (found[:5] > 0).all()
    assert (found[6:] < 0).all()


def test_it_scales_with_the_points():
    cloud, points = sphere(), sphere(1.1, 20)
    np.testing.assert_allclose(asymmetry(50 * points, PLANE, 50 * cloud), 50 * asymmetry(points, PLANE, cloud))
