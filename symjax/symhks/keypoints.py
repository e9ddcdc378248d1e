"""Keypoints: intrinsic shape signatures, and farthest-point samples where those leave the cloud bare.

Zhong, "Intrinsic Shape Signatures", ICCV Workshops 2009: a point is a keypoint where its neighbourhood's scatter
varies in all three directions (no two eigenvalues are alike) and where the smallest eigenvalue is a local maximum.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

RADIUS = 0.1
"""Radius of the neighbourhood in units of the cloud's diagonal (the paper's r): about 100 of 5 000 points."""

NUM_NEIGHBOURS = 100
"""Neighbours (the paper's h) that the radius may hold on the median: a slender cloud has more of them within it."""

MAX_RATIO = 0.975
"""Largest ratio of consecutive eigenvalues at a keypoint (Zhong's γ21 and γ32, in the usual setting)."""

MIN_RATIO = 1e-4
"""Smallest ratio of the least eigenvalue to the largest at a keypoint: below this, a neighbourhood counts as flat
despite rounding."""

SUPPRESSION = 0.3
"""Within this share of the radius only the most salient point stays."""

NUM_KEYPOINTS = 500
"""Keypoints kept. The mirror twin of a keypoint must be near another one, so that they must cover the cloud."""


class Keypoints(NamedTuple):
    """Rows of the cloud: first the `num_salient` intrinsic shape signatures, then farthest-point samples.

    `spacing` is the median distance of the cloud's points from the nearest keypoint other than themselves.
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
    """Intrinsic shape signatures, the most salient half of the keypoints at most, topped up to cover the cloud.

    The paper matches intrinsic shape signatures alone. On 5 000 random surface points there are about 60 of them,
    and the twin of one is often none: farthest-point samples fill the rest of the cloud evenly.

    Args:
        points: the cloud, in units of its diagonal.
        num_keypoints: number of keypoints, capped at n.
        radius: of the neighbourhood, in units of the diagonal.
        num_neighbours: points that the neighbourhood may hold on the median; None does not bound them.
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
    """The radius, or a smaller one that holds about `num_neighbours` points of a dense or slender cloud."""
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
    """Rows of the intrinsic shape signature keypoints, the most salient first.

    Args:
        points: the cloud.
        radius: of the neighbourhood whose scatter is taken, in the units of the points.
        max_ratio: largest ratio of consecutive eigenvalues.
        min_neighbours: points with fewer neighbours are no keypoints.
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
    """Rows of `num_keypoints` points, each the farthest from those before it.

    Args:
        points: the cloud.
        num_keypoints: number of rows, the seeds included; at most n.
        seeds: rows to begin with; by default the point farthest from the mean.
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
    """Eigenvalues, ascending, of each point's scatter, its neighbours weighted by 1 / their own crowding."""
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
    """Whether no candidate among a point's neighbours is more salient."""
    best = np.zeros(len(saliency))
    np.maximum.at(best, row, np.where(candidate, saliency, 0.0)[column])
    return saliency >= best
