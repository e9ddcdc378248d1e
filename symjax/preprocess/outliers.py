"""Scattered outliers: points that lie in space, not on a surface, recognised by the distance to their neighbours.

Points strewn evenly over a volume have a density that two measurements agree on: the distances between neighbours,
and their number over the volume. Points of a surface do not: their neighbours are much nearer than their number would
have it, and lie in a plane. No scale, share or distance is assumed, and a cloud without outliers loses hardly anything.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import ConvexHull, QhullError, cKDTree

from symjax.geometry.local_frames import local_frames

NUM_NEIGHBOURS = 12
"""Neighbours whose mean distance is a point's crowding: more of them blur thin parts, fewer are noisy."""

SAME_DENSITY = 1.9
"""Ratio of the two densities, in the points' convex hull, up to which points may be strewn over it. Measured: strewn
points 0.9 to 1.6; the sparser half of a whole or noisy surface 2.2 to 18, but of a scan from one side 0.4 and more."""

ISOTROPIC = 0.09
"""Least share of the neighbours' variance, of three directions, from which on they fill space: strewn points 0.10 to
0.16 on the median, surfaces without noise 0 to 0.13, scans from one side 0 to 0.10. Either bound alone errs; both
together parted all of 900 clouds of 5 000 points and more."""

ISOLATED = 10.0
"""A point is isolated if its neighbours are this many times farther away than usual."""

APART = 0.305
"""Least distance of the two parts' mean logarithms of crowding: at this, the sparser one is 1.36 times as sparse
along a line. Measured: 0.24 to 0.30 where a clean surface of few points passed the two bounds above, 0.31 to 0.8 with
outliers."""

NUM_PROBES = 400

MAX_ROUNDS = 4
"""Where outliers are many, those near the surface pass the first round, and are seen once the others are gone."""


def scattered(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
    """Which points are scattered outliers.

    Round by round, the points are parted in two by Otsu's threshold on the logarithm of their crowding, and the sparser
    part is taken away if it is strewn evenly over the volume.

    Args:
        points: distinct points, in any units.
    """
    rows = np.flatnonzero(~_isolated(points))
    for _ in range(MAX_ROUNDS):
        if len(rows) <= NUM_NEIGHBOURS:
            break
        distance, near = _neighbours(points[rows])
        crowding = np.log(distance.mean(axis=1))
        sparse = np.flatnonzero(crowding > otsu_threshold(crowding))
        apart = crowding[sparse].mean() - np.delete(crowding, sparse).mean() if len(sparse) else 0.0
        if apart < APART or not _fill_space(points[rows], sparse, distance, near):
            break
        rows = np.delete(rows, sparse)
    outlier = np.ones(len(points), bool)
    outlier[rows] = False
    return outlier


def _neighbours(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "n k"], Int[np.ndarray, "n k"]]:
    distance, near = cKDTree(points).query(points, k=NUM_NEIGHBOURS + 1, workers=-1)
    return distance[:, 1:], near[:, 1:]


def _fill_space(
    points: Float[np.ndarray, "n 3"],
    sparse: Int[np.ndarray, " m"],
    distance: Float[np.ndarray, "n k"],
    near: Int[np.ndarray, "n k"],
) -> bool:
    """Whether the sparse points are strewn evenly over the cloud's convex hull."""
    # density of a Poisson process, by maximum likelihood from the distances to its k-th neighbours
    local = NUM_NEIGHBOURS * len(sparse) / float((4 / 3 * np.pi * distance[sparse, -1] ** 3).sum())
    try:
        volume = ConvexHull(points).volume
    except QhullError:  # flat to rounding: nothing fills space
        return False
    if local * volume > SAME_DENSITY * len(sparse):
        return False
    variance = local_frames(points, near[sparse[:: max(1, len(sparse) // NUM_PROBES)]])[0]
    return bool(np.median(variance[:, 0] / variance.sum(axis=1)) > ISOTROPIC)


def _isolated(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
    if len(points) <= NUM_NEIGHBOURS:
        return np.zeros(len(points), bool)
    crowding = _neighbours(points)[0].mean(axis=1)
    return crowding > ISOLATED * np.median(crowding)


def otsu_threshold(values: Float[np.ndarray, " n"], *, num_bins: int = 128) -> float:
    """The threshold that parts values in two classes of the least variance within (Otsu 1979)."""
    count, edges = np.histogram(values, num_bins)
    below = np.cumsum(count)
    moment = np.cumsum(count * 0.5 * (edges[1:] + edges[:-1]))
    total = below[-1]
    between = (moment[-1] * below / total - moment) ** 2 / np.maximum(below * (total - below), 1)
    return float(edges[1 + np.argmax(between[:-1])])
