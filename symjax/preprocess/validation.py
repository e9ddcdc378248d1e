"""Checks of the input points and normals."""

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from symjax.errors import InvalidPointsError, NonfiniteError, TooFewPointsError

MIN_POINTS = 50
"""Fewer points have no meaningful spectrum; pairs can still be fitted."""


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
        shape: shape of the array of the input points.
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
