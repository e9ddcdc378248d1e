"""Bad points raise typed errors; a prepared cloud does not depend on units, position, pose or order."""

import numpy as np
import pytest

from symjax.errors import (
    DegenerateCloudError,
    DuplicatePointsWarning,
    InvalidArgumentError,
    InvalidPointsError,
    NonfiniteError,
    PrecisionWarning,
    SymjaxError,
    TooFewPointsError,
)
from symjax.preprocess.cloud import MAX_POINTS, prepare


def blob(rng, num_points=500):
    return rng.normal(size=(num_points, 3)) * [1.0, 2.0, 3.0]


def rotation(rng):
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


@pytest.mark.parametrize(
    ("points", "error", "words"),
    [
        (np.empty((0, 3)), TooFewPointsError, "empty"),
        ([], TooFewPointsError, "empty"),
        (np.zeros((3, 3)), TooFewPointsError, "3 points"),
        (np.arange(147.0).reshape(49, 3), TooFewPointsError, "fit_plane"),
        (np.ones((3, 100)), InvalidPointsError, "transpose"),
        (np.ones((100, 2)), InvalidPointsError, "third column"),
        (np.ones((100, 6)), InvalidPointsError, r"points\[:, :3\]"),
        (np.ones(300), InvalidPointsError, "shape"),
        (np.ones((2, 100, 3)), InvalidPointsError, "shape"),
        ([[1, 2, 3], [1, 2]], InvalidPointsError, "differ in length"),
        (np.ones((100, 3), dtype=object), InvalidPointsError, "object"),
        (np.ones((100, 3), dtype=complex), InvalidPointsError, "complex"),
        (np.ones((100, 3), dtype=bool), InvalidPointsError, "bool"),
        (np.full((100, 3), "1.0"), InvalidPointsError, "real numbers"),
        (np.ones((100, 3)), DegenerateCloudError, "coincide"),
        (np.outer(np.linspace(0, 1, 100), [1, 2, 3]), DegenerateCloudError, "one line"),
        (np.zeros((100, 3)), DegenerateCloudError, "coincide"),
    ],
)
def test_bad_points_raise_a_typed_error_that_says_what_to_do(points, error, words):
    with pytest.raises(error, match=words) as caught:
        prepare(points)
    assert isinstance(caught.value, SymjaxError)
    assert isinstance(caught.value, ValueError)


def test_lists_and_integers_convert(rng):
    grid = rng.integers(0, 1000, size=(200, 3))
    np.testing.assert_array_equal(prepare(grid).points, prepare(grid.tolist()).points)
    np.testing.assert_array_equal(prepare(grid).points, prepare(grid.astype(float)).points)


def test_nonfinite_points_are_refused_with_their_count_or_dropped_on_request(rng):
    points = blob(rng)
    points[7], points[9] = np.nan, np.inf
    with pytest.raises(NonfiniteError, match=r"2 of 500 .* first at index 7"):
        prepare(points)
    cloud = prepare(points, nonfinite="drop")
    assert cloud.num_given == 500
    assert set(range(500)) - set(cloud.rows.tolist()) == {7, 9}
    assert "2 of 500" in cloud.notes[0]
    with pytest.raises(InvalidArgumentError, match="ignore"):
        prepare(points, nonfinite="ignore")


def test_the_map_back_is_exact(rng):
    points = blob(rng) + 5.0
    cloud = prepare(points)
    back = cloud.to_given.points(cloud.points)
    np.testing.assert_allclose(back, points[cloud.rows], rtol=1e-12)
    frame = cloud.to_given.rotation
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-14)


@pytest.mark.parametrize("scale", [1e-160, 1e-12, 1.0, 1e12, 1e160, 1e306])
def test_units_do_not_matter(rng, scale):
    points = blob(rng)
    reference, cloud = prepare(points), prepare(points * scale)
    np.testing.assert_allclose(cloud.points, reference.points, atol=1e-12)
    np.testing.assert_allclose(cloud.diagonal, reference.diagonal * scale, rtol=1e-12)


@pytest.mark.parametrize("handedness", [1.0, -1.0])
def test_position_pose_and_order_do_not_matter(rng, handedness):
    points = blob(rng)
    turn, shift = rotation(rng), rng.normal(size=3) * 1e6
    turn *= np.sign(np.linalg.det(turn)) * handedness
    order = rng.permutation(len(points))
    reference, cloud = prepare(points), prepare((points @ turn.T + shift)[order])
    np.testing.assert_allclose(cloud.points, reference.points, atol=1e-9)
    np.testing.assert_array_equal(order[cloud.rows], reference.rows)
    np.testing.assert_allclose(cloud.diagonal, reference.diagonal, rtol=1e-9)


def test_thinning_is_bounded_and_equivariant(rng):
    points = blob(rng, 4 * MAX_POINTS)
    turn, order = rotation(rng), rng.permutation(len(points))
    cloud, turned = prepare(points), prepare((points @ turn.T)[order])
    assert 0.5 * MAX_POINTS < len(cloud.points) <= MAX_POINTS
    assert any("thinned" in note for note in cloud.notes)
    same = np.intersect1d(cloud.rows, order[turned.rows])
    # only points within rounding of the border of a cell may change cells
    assert len(same) > 0.999 * len(cloud.rows)


def test_duplicates_are_merged_and_original_rows_kept(rng):
    points = blob(rng)
    doubled = np.concatenate([points, points[:100]])
    with pytest.warns(DuplicatePointsWarning, match="100 of 600"):
        cloud = prepare(doubled)
    assert set(cloud.rows % 500) == set(range(500))
    assert len(cloud.rows) == 500
    few = prepare(np.concatenate([points, points[:3]]))
    assert len(few.points) == 500
    assert "3 points coincide" in few.notes[0]


def test_coplanar_points_are_accepted_with_a_note(rng):
    flat = blob(rng)
    flat[:, 1] = 2.0
    assert any("coplanar" in note for note in prepare(flat).notes)


def test_float32_far_from_the_origin_causes_a_warning(rng):
    near = blob(rng, 60).astype(np.float32)
    prepare(near)
    with pytest.warns(PrecisionWarning, match="float32"):
        prepare(near + np.float32(2e6))
