"""The scene: its quads, its view, what it keeps of the points and pairs, and its headline."""

import numpy as np
import pytest

from symjax.errors import InvalidArgumentError, TooFewPointsError
from symjax.geometry.plane import Plane
from symjax.viz.scene import build, headline, robust_bounds, thin
from tests.helpers.detections import blob, detection_of


def scene_of(points, **changes):
    return build(detection_of(points, **changes), max_points=1000, max_pairs=100)


def test_the_quad_lies_on_the_plane_is_a_rectangle_and_spans_the_cloud(rng):
    scene = scene_of(blob(rng), candidates=3)
    np.testing.assert_allclose(scene.plane.signed_distance(scene.quad), 0.0, atol=1e-12)
    sides = np.roll(scene.quad, -1, axis=0) - scene.quad
    np.testing.assert_allclose((sides * np.roll(sides, -1, axis=0)).sum(axis=1), 0.0, atol=1e-12)
    length = np.linalg.norm(sides, axis=1)
    for side, size in zip(sides[:2], length[:2], strict=True):
        low, high = robust_bounds((scene.cloud @ side / size)[:, None])
        along = scene.quad @ side / size
        assert along.min() < low < high < along.max()
    assert len(scene.others) == 2


def test_cloud_mirror_image_and_pairs_agree_with_the_plane(rng):
    points = blob(rng)
    scene = scene_of(points, weights=(1.0, 0.6, 0.4, 0.0))
    np.testing.assert_allclose(scene.cloud + scene.origin, points, atol=1e-12)
    np.testing.assert_allclose(scene.plane.reflect(scene.cloud), scene.mirrored, atol=1e-12)
    np.testing.assert_allclose(scene.plane.reflect(scene.x), scene.y, atol=1e-12)
    assert scene.is_inlier.tolist() == [True, True, False, False]
    assert (scene.num_inliers, scene.num_pairs) == (2, 4)


def test_a_distant_cloud_keeps_its_precision(rng):
    points, normal, far = blob(rng), np.array([0.6, 0.0, 0.8]), np.array([1e8, -3e8, 2e8])
    here, there = scene_of(points), scene_of(points + far, offset=0.3 + normal @ far)
    np.testing.assert_allclose(there.cloud, here.cloud, atol=1e-6)
    np.testing.assert_allclose(there.plane.offset, here.plane.offset, atol=1e-6)
    np.testing.assert_allclose(there.quad, here.quad, atol=1e-5)


def test_the_view_is_orthonormal_and_up_is_up(rng):
    up = np.array([0.0, 1.0, 0.0])  # within the plane
    view = build(detection_of(blob(rng)), max_points=100, max_pairs=0, up=up).view
    frame = np.stack(view)
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(view.right @ up, 0.0, atol=1e-12)
    assert view.up @ up > 0.9
    # both the face and the depth of the plane are visible
    assert 0.2 < abs(view.towards @ [0.6, 0.0, 0.8]) < 0.8


def test_removed_points_are_separate_and_points_that_are_not_finite_are_dropped(rng):
    outliers = np.array([[50.0, 0.0, 0.0], [0.0, -50.0, 0.0], [np.nan, 0.0, 0.0]])
    points = np.concatenate([blob(rng), outliers])
    scene = scene_of(points, used=np.arange(400), cleaned=True)
    np.testing.assert_allclose(scene.cloud + scene.origin, points[:400], atol=1e-12)
    np.testing.assert_allclose(scene.removed + scene.origin, outliers[:2], atol=1e-12)


def test_thinning_keeps_the_order_and_repeats_no_row():
    rows = thin(np.arange(1000), 50)
    assert len(rows) == 50
    assert (np.diff(rows) > 0).all()
    np.testing.assert_array_equal(thin(np.arange(5), 50), np.arange(5))


def test_a_few_distant_points_hardly_enlarge_the_box(rng):
    values = rng.uniform(size=(2000, 1))
    low, high = robust_bounds(np.concatenate([values, [[1e6]]]))
    assert -0.01 < low[0] < high[0] < 1.6


@pytest.mark.parametrize("up", [(0, 0, 0), (1, 0), (np.nan, 0, 1)])
def test_bad_arguments_are_refused(up, rng):
    with pytest.raises(InvalidArgumentError, match="up must be"):
        build(detection_of(blob(rng)), max_points=100, max_pairs=0, up=np.array(up, float))
    with pytest.raises(InvalidArgumentError, match="max_points"):
        build(detection_of(blob(rng)), max_points=0, max_pairs=0)


def test_a_detection_without_points_is_refused(rng):
    with pytest.raises(TooFewPointsError, match="loaded without its points"):
        build(detection_of(blob(rng), points=None), max_points=100, max_pairs=0)
    with pytest.raises(TooFewPointsError, match="no finite point"):
        build(detection_of(np.full((60, 3), np.nan)), max_points=100, max_pairs=0)


def test_the_headline_states_the_plane_and_the_evidence(rng):
    plane, evidence = headline(detection_of(blob(rng), weights=(1.0,) * 4))
    assert plane == "Mirror plane (0.6000, 0.0000, 0.8000) · x = 0.3"
    assert evidence == "Score 0.600, above the threshold of 0.300; 75% of 4 pairs are inliers"
    lowest = Plane(np.array([0.0, 0.0, 1.0]), np.float64(-0.0))
    plane, evidence = headline(detection_of(blob(rng), plane=lowest, found=False, score=0.1, inlier_fraction=None))
    assert plane == "No mirror plane found; best candidate (0.0000, 0.0000, 1.0000) · x = 0"
    assert evidence == "Score 0.100, not above the threshold of 0.300"
    several = detection_of(blob(rng), ambiguous=True, symmetry="axis")
    assert headline(several)[1].endswith("; ambiguous: every plane through the axis is equally good")
