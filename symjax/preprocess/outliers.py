"""Detection of outliers: points that lie in space instead of on a surface.

The density of points that are uniform in a volume can be estimated in two ways that agree: from the distances between
neighbours, and from their number divided by the volume. Points on a surface differ: their neighbours are much nearer
than their number suggests, and lie in a plane. A surface also has a void on at least one side, however sparse and
uneven its points are, while outliers of any distribution have no large voids between them. The test assumes no scale
and no fraction of outliers, and a cloud without outliers loses very few points.
"""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import ConvexHull, QhullError, cKDTree

from symjax.geometry.directions import fibonacci
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
of the two bounds alone makes errors; together they classified all of 900 even clouds of 5 000 points and more."""

ISOLATED = 10.0
"""A point may be isolated if the mean distance to its neighbours is this many times the median over all points."""

MIN_SEPARATION = 0.305
"""Smallest difference of the mean log distances of sparse and dense points: the neighbours of the sparse ones are 1.36
times as far away. Measured: 0.24 to 0.30 where a clean surface of few points passed the two bounds above, 0.31 to 0.8
with outliers."""

NUM_PROBES = 400
"""Sparse points, about, whose neighbourhoods are tested for a plane."""

TWO_PARTS = 0.5
"""Smallest difference of the mean log distances at which sparse points are two parts: outliers, and the sparse part of
a surface."""

MIN_VOID = 1.4
"""Smallest radius of the voids (see `void_radius`) beside the sparse part of a surface. Measured: 0.8 to 1.2 for
outliers of six distributions, up to 1.36 for those that the first round left; 1.48 and more for sparse parts of
unevenly sampled surfaces that passed the bounds above."""

MIN_VOID_ISOLATED = 1.28
"""The same for isolated points. Measured: 0.9 to 1.26 for outliers that pass `TOGETHER`, 1.31 to 2.1 for the large
faces of 9 meshes sampled by faces or vertices."""

TOGETHER = 0.45
"""Smallest fraction of a part of a surface among the six nearest neighbours of its points. Measured: 0.49 to 0.89 for
isolated points of those 9 meshes, 0 to 0.42 for the outermost outliers, which have a void beside them."""

VOID_PROBES = 200
"""Points of a part, about, whose voids are measured."""

VOID_NEIGHBOURS = 48
"""Neighbours that may bound a void. Its radius is known up to their distance: twice that of the sixth in a volume, 2.8
times on a surface."""

VOID_DIRECTIONS = 120
"""Directions in which a void may lie."""

MAX_ROUNDS = 4
"""Among many outliers, those near the surface pass the first round and are found once the others are removed."""


def outlier_mask(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
    """Finds the outliers of a cloud.

    Each round splits the points in two by Otsu's threshold on the logarithm of the mean distance to their neighbours.
    It removes the sparse ones if they are uniform in the volume and have no voids beside them, and ends the search if
    not. A sparse part of the surface among the sparse ones stays.

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
        sparse, separation = _sparser_part(sparsity)
        if separation < MIN_SEPARATION or not _are_uniform(points[rows], sparse, distance, near):
            break
        rows = np.delete(rows, _without_surface(points[rows], sparsity, sparse))
    outlier = np.ones(len(points), bool)
    outlier[rows] = False
    return outlier


def _sparser_part(sparsity: Float[np.ndarray, " n"]) -> tuple[Int[np.ndarray, " m"], float]:
    """Returns the rows of the sparser of two parts, and the difference of the parts' means; 0 if there is one part."""
    sparse = np.flatnonzero(sparsity > otsu_threshold(sparsity))
    return sparse, sparsity[sparse].mean() - np.delete(sparsity, sparse).mean() if len(sparse) else 0.0


def _without_surface(
    points: Float[np.ndarray, "n 3"], sparsity: Float[np.ndarray, " n"], sparse: Int[np.ndarray, " m"]
) -> Int[np.ndarray, " r"]:
    """Returns the sparser of the sparse points if the others are a surface once these are removed; otherwise all."""
    sparser, separation = _sparser_part(sparsity[sparse])
    rest = np.delete(np.arange(len(points)), sparse[sparser])
    if separation < TWO_PARTS or len(rest) <= NUM_NEIGHBOURS:
        return sparse
    others = np.searchsorted(rest, np.delete(sparse, sparser))
    _, near = _neighbours(points[rest])
    together = _among_themselves(others, near) >= TOGETHER
    return sparse[sparser] if together and void_radius(points[rest], others) >= MIN_VOID else sparse


def _among_themselves(part: Int[np.ndarray, " m"], near: Int[np.ndarray, "n k"]) -> float:
    """Computes the fraction of a part of the points among the six nearest neighbours of its own points."""
    return float(np.isin(near[part, :6], part).mean())


def void_radius(points: Float[np.ndarray, "n 3"], part: Int[np.ndarray, " m"]) -> float:
    """Computes the radius of the voids beside a part of the points: of empty balls that touch them.

    For each point it finds the largest empty ball that touches the point, and divides its radius by the distance to
    the sixth neighbour. The result is the lower quartile: three quarters of the part have a larger void, as nearly all
    points of a surface do, but of outliers only those at the edge of their distribution. Such balls are the polar balls
    of the Delaunay triangulation (Amenta and Bern 1999), here among the nearest neighbours alone.

    Args:
        points: all points that may bound a void, distinct.
        part: rows of the part, at least one.

    Returns:
        About 1 for outliers, up to 2.8 for a surface and 8 for a line.
    """
    probes = part[:: max(1, len(part) // VOID_PROBES)]
    num = min(VOID_NEIGHBOURS, len(points) - 1)
    distance, near = cKDTree(points).query(points[probes], k=num + 1, workers=-1)
    offset = points[near[:, 1:]] - points[probes, None]
    # a ball that touches a point and has its centre in direction u meets a neighbour at offset v if its curvature is
    # 2 u.v / v.v
    inverted = 2 * offset / np.maximum((offset**2).sum(axis=2, keepdims=True), np.finfo(float).tiny)
    curvature = (inverted @ fibonacci(VOID_DIRECTIONS, half=False).T).max(axis=1).min(axis=1)
    radius = 1 / np.maximum(curvature, 1 / distance[:, -1])
    return float(np.quantile(radius / distance[:, min(6, num)], 0.25))


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
    """Returns whether the sparse points are uniform in the convex hull of the cloud, with no voids beside them."""
    # maximum-likelihood density of a Poisson process, given the distances to the k-th neighbours
    local = NUM_NEIGHBOURS * len(sparse) / float((4 / 3 * np.pi * distance[sparse, -1] ** 3).sum())
    try:
        volume = ConvexHull(points).volume
    except QhullError:  # the cloud is flat up to rounding and has no volume
        return False
    if local * volume > SAME_DENSITY * len(sparse):
        return False
    variance = local_frames(points, near[sparse[:: max(1, len(sparse) // NUM_PROBES)]])[0]
    if np.median(variance[:, 0] / variance.sum(axis=1)) <= ISOTROPIC:
        return False
    return void_radius(points, sparse) < MIN_VOID


def _isolated(points: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
    """Returns which points are far from all others, unless they are the sparse part of a surface."""
    isolated = np.zeros(len(points), bool)
    if len(points) <= NUM_NEIGHBOURS:
        return isolated
    distance, near = _neighbours(points)
    sparsity = distance.mean(axis=1)
    level = ISOLATED * np.median(sparsity)
    while level > 0 and (beyond := np.flatnonzero(sparsity > level)).size:
        if _among_themselves(beyond, near) < TOGETHER or void_radius(points, beyond) < MIN_VOID_ISOLATED:
            isolated[beyond] = True
            break
        # a speck may lie far beyond the sparse part of a surface
        level *= 3
    return isolated


def otsu_threshold(values: Float[np.ndarray, " n"], *, num_bins: int = 128) -> float:
    """Computes the threshold that splits values into two classes of least within-class variance (Otsu 1979)."""
    count, edges = np.histogram(values, num_bins)
    below = np.cumsum(count)
    moment = np.cumsum(count * 0.5 * (edges[1:] + edges[:-1]))
    total = below[-1]
    between = (moment[-1] * below / total - moment) ** 2 / np.maximum(below * (total - below), 1)
    return float(edges[1 + np.argmax(between[:-1])])
