"""The surface that a cloud samples: its normals, the confidence in every point, and its boundary."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

NUM_NEIGHBOURS = 32
"""Neighbours that are used: fewer than 32 cannot tell the boundary of a surface from a gap in a random sample."""

FINE, COARSE = 16, NUM_NEIGHBOURS
"""Neighbours that a normal is taken from: more where noise, not curvature, thickens the surface."""

NOISY = 0.25
"""Thickness in spacings beyond which a surface may be noisy."""

GROWTH = 1.5
"""Noise thickens a larger neighbourhood hardly more than a small one (measured 1.0 to 1.3), curvature in proportion to
its area (2)."""

BOUNDARY = 0.3
"""Distance of a point from the mean of its neighbours, in radii of the neighbourhood, beyond which the point lies on
the boundary: 0.42 at a straight edge, 0 inside, and 0.1 of scatter."""

CONFIDENCE_NEIGHBOURS = 8

FLAT = 1e-6
"""Ratio of singular values below which a cloud is a flat sheet."""


class Surface(NamedTuple):
    """A cloud as a sampled surface, in the units of the points.

    Attributes:
        points: the points.
        normals: unit normals of either orientation.
        confidence: how well a point agrees with its neighbours' tangent planes and normals, 0 to 1: its mirror image
            cannot agree better. That of an outlier is almost 0.
        boundary: whether the surface ends at a point.
        spacing: side of the square that one point has to itself, on the median.
        thickness: standard deviation of the points about their neighbours' planes, on the median.
        noisy: whether that is noise, not curvature.
        tree: of the points.
    """

    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "n 3"]
    confidence: Float[np.ndarray, " n"]
    boundary: Bool[np.ndarray, " n"]
    spacing: float
    thickness: float
    noisy: bool
    tree: cKDTree

    @property
    def flat(self) -> bool:
        """Whether the cloud is a flat sheet: then only its outline distinguishes its mirror planes."""
        singular = np.linalg.svd(self.points - self.points.mean(axis=0), compute_uv=False)
        return bool(singular[2] < FLAT * singular[0])

    @property
    def tolerance(self) -> float:
        """Distance from a tangent plane that is not remarkable: half a spacing, or the noise."""
        return max(0.5 * self.spacing, 1.5 * self.thickness)


def estimate_surface(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    use_confidence: bool = True,
) -> Surface:
    """Estimates normals, point confidence and boundary of a cloud.

    Args:
        points: distinct points.
        normals: normals of any length and orientation, if they are known.
        use_confidence: whether points differ in confidence; if not, all have confidence 1.
    """
    tree = cKDTree(points)
    count = min(NUM_NEIGHBOURS, len(points) - 1)
    distance, near = (found[:, 1:] for found in tree.query(points, k=count + 1, workers=-1))
    # the k-th neighbour of Poisson points in a plane is at √(k/π) spacings
    spacing = float(np.median(distance[:, 5]) / np.sqrt(6 / np.pi))
    noisy = _is_noisy(points, near, spacing)
    near_enough = near[:, : COARSE if noisy else FINE]
    confidence = np.ones(len(points))
    # the second time without the points that belong to no surface
    for _ in range(2):
        variance, least = _scatter(points, near_enough, confidence)
        thickness = float(np.median(np.sqrt(variance)))
        if normals is not None:
            least = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        if use_confidence:
            confidence = _confidence(points, least, near, max(0.5 * spacing, 1.5 * thickness))
    boundary = _is_boundary(points, least, near, distance)
    return Surface(points, least, confidence, boundary, spacing, thickness, noisy, tree)


def _is_noisy(points: Float[np.ndarray, "n 3"], near: Int[np.ndarray, "n k"], spacing: float) -> bool:
    """Whether noise, not curvature, thickens the surface."""
    probes = np.arange(0, len(points), max(1, len(points) // 500))
    alike = np.ones(len(points))
    fine, coarse = (
        float(np.median(np.sqrt(_scatter(points, near[probes, :size], alike)[0]))) for size in (FINE, COARSE)
    )
    return fine > NOISY * spacing and coarse < GROWTH * fine


def _scatter(
    points: Float[np.ndarray, "n 3"], near: Int[np.ndarray, "m k"], weight: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, " m"], Float[np.ndarray, "m 3"]]:
    """Least variance of neighbours about their mean, and its direction."""
    normalised = weight[near] + 1e-6
    normalised = normalised / normalised.sum(axis=1, keepdims=True)
    offset = points[near]
    offset = offset - np.matmul(normalised[:, None], offset)
    weighted = np.sqrt(normalised)[:, :, None] * offset
    values, vectors = np.linalg.eigh(np.matmul(weighted.transpose(0, 2, 1), weighted))
    return np.maximum(values[:, 0], 0.0), vectors[:, :, 0]


def _confidence(
    points: Float[np.ndarray, "n 3"], normals: Float[np.ndarray, "n 3"], near: Int[np.ndarray, "n k"], tolerance: float
) -> Float[np.ndarray, " n"]:
    near = near[:, :CONFIDENCE_NEIGHBOURS]
    theirs = normals[near]
    height = ((points[:, None] - points[near]) * theirs).sum(axis=2)
    cosine = (normals[:, None] * theirs).sum(axis=2)
    return (np.exp(-0.5 * (height / tolerance) ** 2) * cosine**2).mean(axis=1)


def _is_boundary(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    near: Int[np.ndarray, "n k"],
    distance: Float[np.ndarray, "n k"],
) -> Bool[np.ndarray, " n"]:
    offset = points[near].mean(axis=1) - points
    offset -= (offset * normals).sum(axis=1, keepdims=True) * normals
    return np.linalg.norm(offset, axis=1) > BOUNDARY * distance[:, -1]
