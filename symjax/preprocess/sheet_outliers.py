"""Outliers of a flat cloud: points scattered over the sheet, between and beyond the points of an outline.

In a sheet, a sparse part of the object fills area as outliers do, and only its density distinguishes it. Points are
outliers if their density is distinct from that of the others, not a continuation of it, and if together they leave no
part of the cloud's convex hull empty.
"""

import numpy as np
from jaxtyping import Bool, Float
from scipy.spatial import ConvexHull, QhullError, cKDTree

from symjax.preprocess.outliers import MAX_ROUNDS, NUM_NEIGHBOURS, otsu_threshold

APART = 0.4
"""Minimum difference of the mean logarithms of the distances to the neighbours, dense against sparse. A uniform sheet
has 0.3 between its edges and the rest; 100 % outliers on a sheet that fills 60 % of its box have 0.5."""

VALLEY, WINDOW = 0.6, 0.1
"""Largest ratio of the number of points within WINDOW of the threshold to that within WINDOW of the dense part's
median. Between two densities there is a valley, a gradient of the density has none. Measured on filled rectangles and
stars: 0.07 to 0.14 with 30 % outliers, 0.5 with 100 %; 0.8 to 2 on clean sheets, even and uneven ones."""

VOIDS, EMPTY, NUM_PLACES = 0.1, 2.0, 2000
"""Largest share of places in the convex hull that are farther than EMPTY mean radii from every point. The share is
0.02 if the sparse points are scattered over what the dense ones leave free."""


def sheet_outlier_mask(points: Float[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
    """Finds the points of a flat cloud that are scattered outliers.

    Args:
        points: distinct points along the sheet, in any units.

    Returns:
        True for each outlier.
    """
    rows = np.arange(len(points))
    for _ in range(MAX_ROUNDS):
        if len(rows) <= 2 * NUM_NEIGHBOURS:
            break
        sparse = _scattered(points[rows])
        if not sparse.any():
            break
        rows = rows[~sparse]
    outlier = np.ones(len(points), bool)
    outlier[rows] = False
    return outlier


def _scattered(points: Float[np.ndarray, "n 2"]) -> Bool[np.ndarray, " n"]:
    """Returns which points are the sparse part of a cloud, if that is scattered over the sheet."""
    none = np.zeros(len(points), bool)
    tree = cKDTree(points)
    crowding = np.log(tree.query(points, k=NUM_NEIGHBOURS + 1)[0][:, 1:].mean(axis=1))
    limit = otsu_threshold(crowding)
    sparse = crowding > limit
    if sparse.sum() < NUM_NEIGHBOURS or sparse.all():
        return none
    if crowding[sparse].mean() - crowding[~sparse].mean() < APART:
        return none
    between, dense = (np.count_nonzero(np.abs(crowding - at) < WINDOW) for at in (limit, np.median(crowding[~sparse])))
    if between > VALLEY * dense:
        return none
    try:
        hull = ConvexHull(points)
    except QhullError:
        return none
    low, high = points.min(axis=0), points.max(axis=0)
    places = low + np.random.default_rng(0).random((NUM_PLACES, 2)) * (high - low)
    places = places[(places @ hull.equations[:, :2].T + hull.equations[:, 2] <= 0).all(axis=1)]
    distance, nearest = tree.query(places)
    free = float(np.mean(sparse[nearest])) * hull.volume
    radius = np.sqrt(free / (np.pi * np.count_nonzero(sparse)))
    return sparse if np.mean(distance > EMPTY * radius) <= VOIDS else none
