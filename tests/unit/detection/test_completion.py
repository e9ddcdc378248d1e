"""Points of the object are near the points that were used; the completed object is its own mirror image."""

import numpy as np

from symjax.detection.completion import NEAR, complete, on_surface
from symjax.geometry.plane import Plane
from tests.helpers.detections import blob, detection_of

GRID = np.stack(np.meshgrid(np.arange(10.0), np.arange(10.0), [0.0]), axis=-1).reshape(-1, 3)
"""Points at distance 1."""


def test_without_used_points_everything_finite_belongs_to_the_object():
    points = np.array([[0.0, 0.0, 1e9], [np.nan, 0.0, 0.0], [0.0, np.inf, 0.0], [1.0, 2.0, 3.0]])
    assert on_surface(points, None).tolist() == [True, False, False, True]


def test_points_near_the_used_points_belong_to_the_object():
    heights = np.array([0.0, NEAR - 0.01, NEAR + 0.01, 100.0, np.nan])
    points = np.c_[np.full(5, 4.0), np.full(5, 5.0), heights]
    assert on_surface(points, GRID).tolist() == [True, True, False, False, False]
    assert on_surface(7 * points, 7 * GRID).tolist() == [True, True, False, False, False]


def test_points_that_were_thinned_belong_to_the_object_and_dropped_outliers_do_not():
    outliers = np.array([[4.0, 4.0, 30.0], [-40.0, 0.0, 0.0]])
    used = np.arange(0, len(GRID), 2)
    detection = detection_of(np.concatenate([GRID, outliers]), used=used, cleaned=True)
    assert detection.on_surface().tolist() == [True] * len(GRID) + [False] * 2
    np.testing.assert_array_equal(detection.complete()[: len(GRID)], GRID)
    assert len(detection.complete()) == 2 * len(GRID)


def test_the_completed_object_is_its_own_mirror_image(rng):
    plane, points = Plane(np.array([0.6, 0.0, 0.8]), np.float64(0.3)), blob(rng, 50)
    whole = complete(points, plane)
    np.testing.assert_array_equal(whole[:50], points)
    np.testing.assert_allclose(plane.reflect(whole), np.roll(whole, 50, axis=0), atol=1e-12)
    np.testing.assert_allclose(plane.signed_distance(whole[50:]), -plane.signed_distance(points), atol=1e-12)
