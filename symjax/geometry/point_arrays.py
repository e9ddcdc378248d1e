"""Conversion of array-likes to arrays of points."""

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from symjax.errors import InvalidPointsError, NonfiniteError, TooFewPointsError


def as_points(points: ArrayLike, *, least: int = 1) -> Float[np.ndarray, "n 3"]:
    """Converts points to a new (n, 3) float64 array.

    Args:
        points: points as an array, or as nested lists.
        least: number of points that the message about an empty array asks for.

    Raises:
        InvalidPointsError: if the rows differ in length, or the array has another shape or is not of real numbers.
        TooFewPointsError: if there are no points.
    """
    try:
        array = np.asarray(points)
    except ValueError as error:
        raise InvalidPointsError("points must be an (n, 3) array, but the rows differ in length") from error
    if array.dtype.kind not in "fiu":
        raise InvalidPointsError(f"points must be real numbers, got {array.dtype}: convert them to float first")
    if array.size == 0:
        noun = "point is" if least == 1 else "points are"
        raise TooFewPointsError(f"points is empty (shape {array.shape}): at least {least} {noun} needed")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = ""
        if array.ndim == 2 and array.shape[0] == 3:
            hint = ": transpose it (points.T)"
        elif array.ndim == 2 and array.shape[1] > 3:
            hint = ": pass the coordinates only (points[:, :3])"
        elif array.ndim == 2 and array.shape[1] == 2:
            hint = ": add a third column for the z coordinate"
        raise InvalidPointsError(f"points must have shape (n, 3), got {array.shape}{hint}")
    return array.astype(float)


def as_finite_points(points: ArrayLike) -> Float[np.ndarray, "n 3"]:
    """Converts points like `as_points`, and refuses NaN and infinity.

    Raises:
        InvalidPointsError: if `points` is not an (n, 3) array of real numbers.
        TooFewPointsError: if there are no points.
        NonfiniteError: if a coordinate is NaN or infinite.
    """
    array = as_points(points)
    finite = np.isfinite(array).all(axis=1)
    if not finite.all():
        raise NonfiniteError(f"point {int(np.argmin(finite))} is NaN or infinite: remove such points")
    return array
