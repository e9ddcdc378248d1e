"""Invalid points and normals are refused, and the message says what to do instead."""

import numpy as np
import pytest

from symjax.errors import InvalidPointsError, NonfiniteError, TooFewPointsError
from symjax.preprocess.validation import MIN_POINTS, as_normals, check_num_points, finite_rows


def test_too_few_points_are_refused():
    check_num_points(MIN_POINTS, "points")
    with pytest.raises(TooFewPointsError, match=f"{MIN_POINTS - 1} distinct points are too few"):
        check_num_points(MIN_POINTS - 1, "distinct points")


def test_rows_that_are_not_finite_are_dropped_and_noted_or_refused():
    points = np.zeros((5, 3))
    points[1, 2], points[4, 0] = np.nan, np.inf
    notes = []
    assert finite_rows(points, "drop", notes).tolist() == [0, 2, 3]
    assert notes == ["2 of 5 points were NaN or infinite and were dropped"]
    with pytest.raises(NonfiniteError, match="2 of 5 points are NaN or infinite, the first at index 1"):
        finite_rows(points, "raise", notes)
    assert finite_rows(points[2:4], "raise", notes).tolist() == [0, 1]
    assert len(notes) == 1


def test_normals_are_selected_by_row_and_bad_ones_in_other_rows_do_not_matter(rng):
    normals = rng.normal(size=(6, 3))
    normals[2], normals[4] = 0.0, np.nan
    np.testing.assert_array_equal(as_normals(normals, (6, 3), np.array([5, 0])), normals[[5, 0]])
    with pytest.raises(InvalidPointsError, match=r"2 normals .* the first at index 2"):
        as_normals(normals, (6, 3), np.arange(6))


@pytest.mark.parametrize(
    ("normals", "message"),
    [
        ([[1, 2, 3], [1, 2]], r"shape \(2, 3\), but the rows differ in length"),
        ([["a"] * 3] * 2, "real numbers, got <U1"),
        (np.ones((3, 3)), r"shape of the points, \(2, 3\), got \(3, 3\)"),
    ],
)
def test_normals_of_another_shape_or_type_are_refused(normals, message):
    with pytest.raises(InvalidPointsError, match=message):
        as_normals(normals, (2, 3), np.arange(2))
