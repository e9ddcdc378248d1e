"""Checks of the given points and normals."""

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from symjax.errors import InvalidPointsError, NonfiniteError, TooFewPointsError

MIN_POINTS = 50
"""Fewer points have no meaningful spectrum; pairs can still be fitted."""


def as_points(points: ArrayLike) -> Float[np.ndarray, "n 3"]:
    """Converts points to an (n, 3) float64 array.

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
        raise TooFewPointsError(f"points is empty (shape {array.shape}): at least {MIN_POINTS} points are needed")
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


def check_num_points(count: int, what: str) -> None:
    """Raises TooFewPointsError if there are fewer than `MIN_POINTS` points."""
    if count < MIN_POINTS:
        raise TooFewPointsError(
            f"{count} {what} are too few: at least {MIN_POINTS} are needed. "
            "If you know pairs of mirrored points, fit a plane to them with symjax.fit_plane(x, y, sigma)"
        )


def finite_rows(
    points: Float[np.ndarray, "n d"], nonfinite: str, notes: list[str], *, noun: str = "points"
) -> Int[np.ndarray, " m"]:
    """Finds the rows without NaN and infinity.

    Args:
        points: one point or pair per row.
        nonfinite: `"raise"` to raise an error if there are other rows, `"drop"` to ignore them.
        notes: list to which a sentence is added if rows are dropped.
        noun: name of the rows in messages.

    Returns:
        The finite rows, ascending.

    Raises:
        NonfiniteError: if a row is not finite and `nonfinite` is `"raise"`.
    """
    finite = np.isfinite(points).all(axis=1)
    bad = int(len(points) - np.count_nonzero(finite))
    if bad and nonfinite == "raise":
        raise NonfiniteError(
            f"{bad} of {len(points)} {noun} are NaN or infinite, the first at index {int(np.argmin(finite))}: "
            "remove them, or pass nonfinite='drop'"
        )
    if bad:
        notes.append(f"{bad} of {len(points)} {noun} were NaN or infinite and were dropped")
    return np.flatnonzero(finite)


def as_normals(normals: ArrayLike, shape: tuple[int, ...], rows: Int[np.ndarray, " m"]) -> Float[np.ndarray, "m 3"]:
    """Converts normals to float64, and selects those of the points that are used.

    Args:
        normals: one normal per given point.
        shape: shape of the array of the given points.
        rows: rows of the points that are used.

    Raises:
        InvalidPointsError: if the rows differ in length, the array has another shape or is not of real numbers, or a
            selected normal is zero, NaN or infinite.
    """
    try:
        array = np.asarray(normals)
    except ValueError as error:
        raise InvalidPointsError(f"normals must be an array of shape {shape}, but the rows differ in length") from error
    if array.dtype.kind not in "fiu":
        raise InvalidPointsError(f"normals must be real numbers, got {array.dtype}")
    if array.shape != shape:
        raise InvalidPointsError(f"normals must have the shape of the points, {shape}, got {array.shape}")
    used: Float[np.ndarray, "m 3"] = array[rows].astype(float)
    bad = ~np.isfinite(used).all(axis=1) | (np.abs(used).max(axis=1) == 0)
    if bad.any():
        raise InvalidPointsError(
            f"{int(bad.sum())} normals are zero, NaN or infinite, the first at index {int(rows[bad].min())}: "
            "correct them, or omit `normals` to have them estimated"
        )
    return used
