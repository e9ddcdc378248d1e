"""Subsets of a cloud: thinned on a grid, drawn at random, or without coincident points."""

import warnings

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import DuplicatePointsWarning

COINCIDENT = 1e-9
"""Points count as one if they are closer than about this fraction of the diagonal."""

WARNING_PERCENTAGE = 1.0
"""Percentage of merged points above which a warning is issued."""


def random_subset(count: int, most: int) -> Int[np.ndarray, " m"]:
    """Draws at most `most` of `count` rows with a fixed seed.

    Relative densities are the same in the subset; `grid_subset` changes them.

    Returns:
        Rows, ascending.
    """
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def grid_subset(points: Float[np.ndarray, "n 3"], max_points: int) -> Int[np.ndarray, " m"]:
    """Keeps one point per grid cell, the one nearest to the centre of the cell.

    The cells are the finest ones, found by bisection, that leave at most `max_points` points.

    Args:
        points: points in the cloud frame, so that the grid rotates and reflects with the cloud.
        max_points: largest number of points to keep.

    Returns:
        Rows of the points that are kept, ascending.
    """
    fine, coarse = 1e-4, 1.0
    for _ in range(12):
        middle = float(np.sqrt(fine * coarse))
        if len(np.unique(_cells(points, middle))) > max_points:
            fine = middle
        else:
            coarse = middle
    cells = _cells(points, coarse)
    off_centre = ((points / coarse - np.floor(points / coarse) - 0.5) ** 2).sum(axis=1)
    order = np.lexsort((off_centre, cells))
    first = np.r_[True, np.diff(cells[order]) != 0]
    return np.sort(order[first])


def _cells(points: Float[np.ndarray, "n 3"], size: float) -> Int[np.ndarray, " n"]:
    cell = np.floor(points / size).astype(np.int64) + 2**20
    return (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]


def distinct_rows(points: Float[np.ndarray, "n 3"], notes: list[str]) -> Int[np.ndarray, " m"]:
    """Keeps the first of each set of coincident points; warns if they are more than 1 % of the points.

    Args:
        points: points in units of the diagonal.
        notes: list to which a sentence is added if points were merged.

    Returns:
        Rows of the points that are kept, ascending.
    """
    keys = np.round(points / COINCIDENT).astype(np.int64)
    order = np.lexsort((np.arange(len(keys)), keys[:, 2], keys[:, 1], keys[:, 0]))
    new = np.r_[True, (np.diff(keys[order], axis=0) != 0).any(axis=1)]
    merged = int(np.count_nonzero(~new))
    if merged:
        notes.append(f"{merged} of {len(points)} points coincide with others and were merged")
    if 100 * merged > WARNING_PERCENTAGE * len(points):
        warnings.warn(notes[-1], DuplicatePointsWarning, stacklevel=4)
    return np.sort(order[new])
