"""Lists and arrays become arrays of points; what is no cloud is refused, and the message says what to do instead."""

import numpy as np
import pytest

from symjax.errors import InvalidPointsError, NonfiniteError, TooFewPointsError
from symjax.geometry.point_arrays import as_finite_points, as_points


@pytest.mark.parametrize("dtype", [np.float64, np.float32, np.int16, np.uint8])
def test_points_of_any_real_type_become_float64(dtype):
    points = np.arange(12).reshape(4, 3).astype(dtype)
    found = as_points(points)
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, points)
    np.testing.assert_array_equal(as_points(points.tolist()), points)


def test_the_given_points_are_not_written_to():
    points = np.zeros((4, 3))
    as_points(points)[:] = 1
    assert not points.any()


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.zeros((3, 8)), "transpose"),
        (np.zeros((8, 6)), "coordinates only"),
        (np.zeros((8, 2)), "third column"),
        (np.zeros((2, 4, 3)), r"got \(2, 4, 3\)"),
        (np.zeros((8, 3), complex), "real numbers"),
        (np.zeros((8, 3), bool), "real numbers"),
        (np.full((8, 3), "1"), "real numbers"),
        ([[1, 2, 3], [1, 2]], "differ in length"),
    ],
)
def test_arrays_that_are_no_cloud_are_refused(points, message):
    with pytest.raises(InvalidPointsError, match=message):
        as_points(points)


def test_an_empty_array_is_refused():
    with pytest.raises(TooFewPointsError, match=r"empty .*: at least 50 points are needed"):
        as_points([], least=50)
    with pytest.raises(TooFewPointsError, match="at least 1 point is needed"):
        as_finite_points(np.empty((0, 3)))


def test_nan_and_infinity_are_refused():
    assert as_finite_points([[1, 2, 3]]).tolist() == [[1.0, 2.0, 3.0]]
    for bad in (np.nan, np.inf):
        with pytest.raises(NonfiniteError, match="point 1 is NaN or infinite"):
            as_finite_points([[0.0, 0.0, 0.0], [0.0, bad, 0.0]])
