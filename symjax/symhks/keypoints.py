"""Keypoints: intrinsic shape signatures, and farthest-point samples where there are none.

Zhong, "Intrinsic Shape Signatures", ICCV Workshops 2009: a point is a keypoint if the scatter matrix of its
neighbourhood has three distinct eigenvalues and the smallest one is a local maximum.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

RADIUS = 0.1
"""Neighbourhood radius in units of the cloud's diagonal (the paper's r): it contains about 100 of 5 000 points."""

NUM_NEIGHBOURS = 100
"""Limit on the median number of neighbours within the radius (the paper's h): a slender cloud would have more."""

MAX_RATIO = 0.975
"""Largest ratio of consecutive eigenvalues at a keypoint (Zhong's γ21 and γ32, at their usual value)."""

MIN_RATIO = 1e-4
"""Least ratio of the smallest eigenvalue to the largest at a keypoint: below it, the neighbourhood is flat up to
rounding."""

SUPPRESSION = 0.3
"""Non-maximum suppression keeps only the most salient point within this fraction of the radius."""

NUM_KEYPOINTS = 500
"""Number of keypoints. They must cover the cloud, since the mirror image of a keypoint must be near another one."""


class Keypoints(NamedTuple):
    """The keypoints of a cloud.

    Attributes:
        rows: rows of the keypoints in the cloud: intrinsic shape signatures first, then farthest-point samples.
        num_salient: number of intrinsic shape signatures.
        spacing: median distance from a point of the cloud to the nearest keypoint other than itself.
    """

    rows: Int[np.ndarray, " a"]
    num_salient: int
    spacing: float


def keypoints(
    points: Float[np.ndarray, "n 3"],
    *,
    num_keypoints: int = NUM_KEYPOINTS,
    radius: float = RADIUS,
    num_neighbours: int | None = NUM_NEIGHBOURS,
) -> Keypoints:
    """Selects keypoints: at most half of them intrinsic shape signatures, the rest farthest-point samples.

    The paper matches only intrinsic shape signatures. 5 000 random surface points have about 60 of them, and the
    mirror image of one is often not near another. Farthest-point samples cover the rest of the cloud evenly.

    Args:
        points: the cloud, in units of its diagonal.
        num_keypoints: number of keypoints, at most n.
        radius: neighbourhood radius, in units of the diagonal.
        num_neighbours: limit on the median number of neighbours within the radius; None sets no limit.

    Returns:
        The keypoints, the most salient first.
    """
    count = min(num_keypoints, len(points))
    salient = shape_signatures(points, radius=_bounded_radius(points, radius, num_neighbours))[: count // 2]
    rows = farthest_points(points, count, seeds=salient)
    return Keypoints(rows, len(salient), _spacing(points, rows))


def _spacing(points: Float[np.ndarray, "n 3"], rows: Int[np.ndarray, " a"]) -> float:
    distance = cKDTree(points[rows]).query(points, k=2)[0]
    nearest = distance[:, 0].copy()
    nearest[rows] = distance[rows, 1]
    return float(np.median(nearest))


def _bounded_radius(points: Float[np.ndarray, "n 3"], radius: float, num_neighbours: int | None) -> float:
    """Returns the radius, or a smaller one that contains about `num_neighbours` points in a dense or slender cloud."""
    if num_neighbours is None:
        return radius
    probes = points[:: max(1, len(points) // 500)]
    neighbours = min(num_neighbours, len(points) - 1)
    return min(radius, float(np.median(cKDTree(points).query(probes, k=neighbours + 1)[0][:, -1])))


def shape_signatures(
    points: Float[np.ndarray, "n 3"],
    *,
    radius: float = RADIUS,
    max_ratio: float = MAX_RATIO,
    min_neighbours: int = 5,
) -> Int[np.ndarray, " a"]:
    """Finds the intrinsic shape signatures of a cloud.

    Args:
        points: the cloud.
        radius: radius of the neighbourhood whose scatter matrix is computed, in the units of the points.
        max_ratio: largest ratio of consecutive eigenvalues.
        min_neighbours: a point with fewer neighbours is not a keypoint.

    Returns:
        Rows of the keypoints, the most salient first.
    """
    pairs = cKDTree(points).query_pairs(radius, output_type="ndarray")
    row = np.concatenate([pairs[:, 0], pairs[:, 1]])
    column = np.concatenate([pairs[:, 1], pairs[:, 0]])
    num_neighbours = np.bincount(row, minlength=len(points))
    eigenvalues = _scatter_eigenvalues(points, row, column, num_neighbours)
    saliency = eigenvalues[:, 0]
    distinct = (
        (saliency > MIN_RATIO * eigenvalues[:, 2])
        & (saliency < max_ratio * eigenvalues[:, 1])
        & (eigenvalues[:, 1] < max_ratio * eigenvalues[:, 2])
        & (num_neighbours >= min_neighbours)
    )
    near = ((points[row] - points[column]) ** 2).sum(axis=1) <= (SUPPRESSION * radius) ** 2
    found = np.flatnonzero(distinct & _local_maximum(saliency, distinct, row[near], column[near]))
    return found[np.argsort(-saliency[found], kind="stable")]


def farthest_points(
    points: Float[np.ndarray, "n 3"], num_keypoints: int, *, seeds: Int[np.ndarray, " s"] | None = None
) -> Int[np.ndarray, " a"]:
    """Selects points by farthest-point sampling: each is the farthest from those selected before it.

    Args:
        points: the cloud.
        num_keypoints: number of points to select, including the seeds; at most n.
        seeds: rows of the first points; by default the point farthest from the mean.

    Returns:
        Rows of the selected points, the seeds first.
    """
    index = [] if seeds is None else [int(i) for i in seeds]
    if not index:
        index.append(int(np.argmax(((points - points.mean(axis=0)) ** 2).sum(axis=1))))
    squared = cKDTree(points[index]).query(points)[0] ** 2
    while len(index) < num_keypoints:
        index.append(int(np.argmax(squared)))
        np.minimum(squared, ((points - points[index[-1]]) ** 2).sum(axis=1), out=squared)
    return np.asarray(index)


def _scatter_eigenvalues(
    points: Float[np.ndarray, "n 3"],
    row: Int[np.ndarray, " e"],
    column: Int[np.ndarray, " e"],
    num_neighbours: Int[np.ndarray, " n"],
) -> Float[np.ndarray, "n 3"]:
    """Computes the ascending eigenvalues of each point's scatter matrix.

    A neighbour is weighted by 1 / the number of its own neighbours.
    """
    weight = 1.0 / np.maximum(num_neighbours, 1)[column]
    total = np.maximum(np.bincount(row, weight, len(points)), np.finfo(float).tiny)
    step = points[column] - points[row]
    scatter = np.empty((len(points), 3, 3))
    for i in range(3):
        for j in range(i + 1):
            moment = np.bincount(row, weight * step[:, i] * step[:, j], len(points)) / total
            scatter[:, i, j] = scatter[:, j, i] = moment
    return np.linalg.eigvalsh(scatter)


def _local_maximum(
    saliency: Float[np.ndarray, " n"],
    candidate: Bool[np.ndarray, " n"],
    row: Int[np.ndarray, " e"],
    column: Int[np.ndarray, " e"],
) -> Bool[np.ndarray, " n"]:
    """Returns whether no candidate among a point's neighbours is more salient than the point."""
    best = np.zeros(len(saliency))
    np.maximum.at(best, row, np.where(candidate, saliency, 0.0)[column])
    return saliency >= best
