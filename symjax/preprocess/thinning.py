"""Fewer points of a cloud: thinned on a grid, drawn evenly, or with coincident points merged."""

import warnings

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import DuplicatePointsWarning

COINCIDENT = 1e-9
"""Points closer than about this share of the diagonal count as one."""

PERCENT_WORTH_A_WARNING = 1.0
"""Share of merged points, in per cent, above which a warning is given."""


def evenly(count: int, most: int) -> Int[np.ndarray, " m"]:
    """At most `most` of the numbers below `count`, drawn with a fixed seed: an even draw keeps relative densities."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


def on_grid(points: Float[np.ndarray, "n 3"], max_points: int) -> Int[np.ndarray, " m"]:
    """Rows of one point a grid cell, the nearest to its centre: the finest cells that leave at most `max_points`.

    Args:
        points: a cloud in its own frame, in units of its diagonal, so that the grid turns and mirrors with the cloud.
        max_points: most rows.
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


def distinct(points: Float[np.ndarray, "n 3"], notes: list[str]) -> Int[np.ndarray, " m"]:
    """Rows of the distinct points, in order; what was merged is noted, and warned of if it is much.

    Args:
        points: a cloud in units of its diagonal.
        notes: a sentence is added to them.
    """
    keys = np.round(points / COINCIDENT).astype(np.int64)
    order = np.lexsort((np.arange(len(keys)), keys[:, 2], keys[:, 1], keys[:, 0]))
    new = np.r_[True, (np.diff(keys[order], axis=0) != 0).any(axis=1)]
    merged = int(np.count_nonzero(~new))
    if merged:
        notes.append(f"{merged} of {len(points)} points coincide with others and were merged")
    if 100 * merged > PERCENT_WORTH_A_WARNING * len(points):
        warnings.warn(notes[-1], DuplicatePointsWarning, stacklevel=4)
    return np.sort(order[new])
