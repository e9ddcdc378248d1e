"""The points as they are given, checked."""

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from symjax.errors import InvalidPointsError, NonfiniteError, TooFewPointsError

MIN_POINTS = 50
"""Fewer points carry no spectrum worth the name; pairs alone can still be fitted."""


def as_points(points: ArrayLike) -> Float[np.ndarray, "n 3"]:
    """The points as an (n, 3) float64 array.

    Raises:
        InvalidPointsError: ragged, of another type than real numbers, or of another shape.
    """
    try:
        array = np.asarray(points)
    except ValueError as error:
        raise InvalidPointsError("points must be an (n, 3) array; these rows differ in length") from error
    if array.dtype.kind not in "fiu":
        raise InvalidPointsError(f"points must be real numbers, not {array.dtype}: convert them to float first")
    if array.size == 0:
        raise TooFewPointsError(f"points is empty (shape {array.shape}); at least {MIN_POINTS} are needed")
    if array.ndim != 2 or array.shape[1] != 3:
        hint = ""
        if array.ndim == 2 and array.shape[0] == 3:
            hint = ": transpose it (points.T)"
        elif array.ndim == 2 and array.shape[1] > 3:
            hint = ": pass the coordinates only (points[:, :3])"
        elif array.ndim == 2 and array.shape[1] == 2:
            hint = ": two coordinates are no 3D cloud; add a third column"
        raise InvalidPointsError(f"points must have shape (n, 3), not {array.shape}{hint}")
    return array.astype(float)


def require(count: int, what: str) -> None:
    """Raises TooFewPointsError for a cloud too small for a plane."""
    if count < MIN_POINTS:
        raise TooFewPointsError(
            f"{count} {what} are too few: at least {MIN_POINTS} are needed. "
            "If you know which points mirror each other, fit the pairs with symjax.fit_plane(x, y, sigma)"
        )


def finite_rows(
    points: Float[np.ndarray, "n d"], nonfinite: str, notes: list[str], *, noun: str = "points"
) -> Int[np.ndarray, " m"]:
    """Rows without NaN and infinity; with `nonfinite="raise"`, NonfiniteError if that is not all of them.

    Args:
        points: one a row.
        nonfinite: `"raise"`, or `"drop"`.
        notes: a sentence is added to them if rows are dropped.
        noun: what the rows are.
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
    """The normals of some rows of the points, as float64.

    Args:
        normals: one for every given point.
        shape: of the array of the given points.
        rows: the rows that are used.

    Raises:
        InvalidPointsError: ragged, of another type or shape, or one of those that are used is zero, NaN or infinite.
    """
    try:
        array = np.asarray(normals)
    except ValueError as error:
        raise InvalidPointsError("normals are ragged: give as many rows of three numbers as points") from error
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise InvalidPointsError(f"normals must be real numbers of shape {shape}, as the points, not {array.shape}")
    array = array[rows].astype(float)
    bad = ~np.isfinite(array).all(axis=1) | (np.abs(array).max(axis=1) == 0)
    if bad.any():
        raise InvalidPointsError(
            f"{int(bad.sum())} normals are zero, NaN or infinite, the first at index {int(rows[bad].min())}: "
            "leave normals out and they are estimated"
        )
    return array
