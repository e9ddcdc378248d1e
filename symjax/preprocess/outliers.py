"""Detection of outliers: points that lie in space instead of on a surface.

The density of points that are uniform in a volume can be estimated in two ways that agree: from the distances between
neighbours, and from their number divided by the volume. Points on a surface differ: their neighbours are much nearer
than their number suggests, and lie in a plane. The test assumes no scale and no fraction of outliers, and a cloud
without outliers loses very few points.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import ConvexHull, QhullError, cKDTree

from symjax.geometry.local_frames import local_frames

NUM_NEIGHBOURS = 12
"""Neighbours over which the distance is averaged: more of them blur thin parts, fewer are noisy."""

SAME_DENSITY = 1.9
"""Largest ratio of the two densities, in the convex hull, of points that are uniform in it. Measured: 0.9 to 1.6 for
uniform points; 2.2 to 18 for the sparser half of a whole or noisy surface, but 0.4 and more for a scan from one
side."""

ISOTROPIC = 0.09
"""Neighbours fill a volume if more than this fraction of their variance is along the direction of least variance.
Medians: 0.10 to 0.16 for uniform points, 0 to 0.13 for surfaces without noise, 0 to 0.10 for scans from one side. Each
of the two bounds alone makes errors; together they classified all of 900 clouds of 5 000 points and more."""

ISOLATED = 10.0
"""A point is isolated if the mean distance to its neighbours is this many times the median over all points."""

MIN_SEPARATION = 0.305
"""Smallest difference of the mean log distances of sparse and dense points: the neighbours of the sparse ones are 1.36
times as far away. Measured: 0.24 to 0.30 where a clean surface of few points passed the two bounds above, 0.31 to 0.8
with outliers."""

NUM_PROBES = 400
"""Sparse points, about, whose neighbourhoods are tested for a plane."""

MAX_ROUNDS = 4
"""Among many outliers, those near the surface pass the first round and are found once the others are removed."""


def outlier_mask(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
    """Finds the outliers of a cloud.

    Each round splits the points in two by Otsu's threshold on the logarithm of the mean distance to their neighbours.
    It removes the sparse ones if they are uniform in the volume, and ends the search if they are not.

    Args:
        points: distinct points, in any units.

    Returns:
        True for each outlier.
    """
    rows = np.flatnonzero(~_isolated(points))
    for _ in range(MAX_ROUNDS):
        if len(rows) <= NUM_NEIGHBOURS:
            break
        distance, near = _neighbours(points[rows])
        sparsity = np.log(distance.mean(axis=1))
        sparse = np.flatnonzero(sparsity > otsu_threshold(sparsity))
        separation = sparsity[sparse].mean() - np.delete(sparsity, sparse).mean() if len(sparse) else 0.0
        if separation < MIN_SEPARATION or not _are_uniform(points[rows], sparse, distance, near):
            break
        rows = np.delete(rows, sparse)
    outlier = np.ones(len(points), bool)
    outlier[rows] = False
    return outlier


def _neighbours(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "n k"], Int[np.ndarray, "n k"]]:
    """Returns the distances and rows of the nearest neighbours of each point."""
    distance, near = cKDTree(points).query(points, k=NUM_NEIGHBOURS + 1, workers=-1)
    return distance[:, 1:], near[:, 1:]


def _are_uniform(
    points: Float[np.ndarray, "n 3"],
    sparse: Int[np.ndarray, " m"],
    distance: Float[np.ndarray, "n k"],
    near: Int[np.ndarray, "n k"],
) -> bool:
    """Returns whether the sparse points are uniform in the convex hull of the cloud."""
    # maximum-likelihood density of a Poisson process, given the distances to the k-th neighbours
    local = NUM_NEIGHBOURS * len(sparse) / float((4 / 3 * np.pi * distance[sparse, -1] ** 3).sum())
    try:
        volume = ConvexHull(points).volume
    except QhullError:  # the cloud is flat up to rounding and has no volume
        return False
    if local * volume > SAME_DENSITY * len(sparse):
        return False
    variance = local_frames(points, near[sparse[:: max(1, len(sparse) // NUM_PROBES)]])[0]
    return bool(np.median(variance[:, 0] / variance.sum(axis=1)) > ISOTROPIC)


def _isolated(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
    if len(points) <= NUM_NEIGHBOURS:
        return np.zeros(len(points), bool)
    distance = _neighbours(points)[0].mean(axis=1)
    isolated: Bool[np.ndarray, " n"] = distance > ISOLATED * np.median(distance)
    return isolated


def otsu_threshold(values: Float[np.ndarray, " n"], *, num_bins: int = 128) -> float:
    """Computes the threshold that splits values into two classes of least within-class variance (Otsu 1979)."""
    count, edges = np.histogram(values, num_bins)
    below = np.cumsum(count)
    moment = np.cumsum(count * 0.5 * (edges[1:] + edges[:-1]))
    total = below[-1]
    between = (moment[-1] * below / total - moment) ** 2 / np.maximum(below * (total - below), 1)
    return float(edges[1 + np.argmax(between[:-1])])
