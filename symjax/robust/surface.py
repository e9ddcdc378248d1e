"""Surface: the surface that a cloud samples, with its normals, the confidence in every point, and its boundary."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

NUM_NEIGHBOURS = 32
"""Neighbours of a point for the boundary test. With fewer, a gap in a random sample looks like a boundary."""

CLEAN_NORMAL_NEIGHBOURS, NOISY_NORMAL_NEIGHBOURS = 16, NUM_NEIGHBOURS
"""Neighbours from which a normal is estimated. A noisy surface needs more."""

NOISY_THICKNESS = 0.25
"""Thickness in spacings above which a surface may be noisy. A thinner one counts as clean."""

NOISE_GROWTH = 1.5
"""A thick surface is noisy if its thickness grows by less than this factor from 16 to 32 neighbours. Noise makes it
grow by a factor of 1.0 to 1.3 (measured); curvature by 2, in proportion to the area of the neighbourhood."""

BOUNDARY_SHIFT = 0.3
"""A point lies on the boundary if its distance from the mean of its neighbours, along the tangent plane, exceeds this
fraction of the neighbourhood's radius. The fraction is 0.42 at a straight edge and 0 inside, with a scatter of 0.1."""

CONFIDENCE_NEIGHBOURS = 8
"""Neighbours whose tangent planes a point is compared with."""

FLAT = 1e-6
"""Ratio of the smallest to the largest singular value of the points below which a cloud is flat."""


class Surface(NamedTuple):
    """A cloud as a sampled surface, in the units of the points.

    Attributes:
        points: the points.
        normals: their unit normals, of either orientation.
        confidence: how well each point agrees with its neighbours' tangent planes and normals, 0 to 1. It is almost 0
            for an outlier. A mirror image of the point cannot be expected to agree better.
        boundary: whether each point lies on the boundary of the surface.
        spacing: side of the square that one point has to itself; median over the points.
        thickness: standard deviation of the points about the best plane of their neighbours; median over the points.
        noisy: whether the thickness is due to noise and not to curvature.
        tree: k-d tree of the points.
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
        """Whether all points lie in one plane: then only the cloud's outline distinguishes its mirror planes."""
        singular = np.linalg.svd(self.points - self.points.mean(axis=0), compute_uv=False)
        return bool(singular[2] < FLAT * singular[0])

    @property
    def tolerance(self) -> float:
        """Distance from a tangent plane that the sampling or the noise explains."""
        return tolerance_of(self.spacing, self.thickness)


def tolerance_of(spacing: float, thickness: float) -> float:
    """Returns half a spacing, or 1.5 standard deviations of the noise if that is more."""
    return max(0.5 * spacing, 1.5 * thickness)


def estimate_surface(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    use_confidence: bool = True,
) -> Surface:
    """Estimates the normals, point confidence and boundary of a cloud.

    Normals and confidence are estimated twice. The second pass weights the neighbours by the confidence of the first,
    so that outliers do not tilt the normals.

    Args:
        points: distinct points, in any units.
        normals: known normals, of any length and orientation; None to estimate them.
        use_confidence: whether to estimate the confidence of each point; otherwise it is 1 for all.

    Returns:
        The surface, in the units of the points.
    """
    tree = cKDTree(points)
    count = min(NUM_NEIGHBOURS, len(points) - 1)
    distances, neighbours = (found[:, 1:] for found in tree.query(points, k=count + 1, workers=-1))
    # the k-th neighbour of a Poisson sample of a plane is at √(k/π) spacings
    spacing = float(np.median(distances[:, 5]) / np.sqrt(6 / np.pi))
    noisy = _is_noisy(points, neighbours, spacing)
    closest = neighbours[:, : NOISY_NORMAL_NEIGHBOURS if noisy else CLEAN_NORMAL_NEIGHBOURS]
    confidence = np.ones(len(points))
    for _ in range(2):
        variance, unit_normals = _thinnest_direction(points, closest, confidence)
        thickness = float(np.median(np.sqrt(variance)))
        if normals is not None:
            unit_normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
        if use_confidence:
            confidence = confidence_of(points, unit_normals, neighbours, tolerance_of(spacing, thickness))
    boundary = _is_boundary(points, unit_normals, neighbours, distances)
    return Surface(points, unit_normals, confidence, boundary, spacing, thickness, noisy, tree)


def _is_noisy(points: Float[np.ndarray, "n 3"], neighbours: Int[np.ndarray, "n k"], spacing: float) -> bool:
    """Returns whether noise, not curvature, thickens the surface."""
    tested = np.arange(0, len(points), max(1, len(points) // 500))
    equal_weights = np.ones(len(points))
    small, large = (
        float(np.median(np.sqrt(_thinnest_direction(points, neighbours[tested, :size], equal_weights)[0])))
        for size in (CLEAN_NORMAL_NEIGHBOURS, NOISY_NORMAL_NEIGHBOURS)
    )
    return small > NOISY_THICKNESS * spacing and large < NOISE_GROWTH * small


def _thinnest_direction(
    points: Float[np.ndarray, "n 3"], neighbours: Int[np.ndarray, "m k"], weight: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, " m"], Float[np.ndarray, "m 3"]]:
    """Returns the smallest principal variance of each neighbourhood, and its direction: the normal."""
    normalised = weight[neighbours] + 1e-6
    normalised = normalised / normalised.sum(axis=1, keepdims=True)
    offset = points[neighbours]
    offset = offset - np.matmul(normalised[:, None], offset)
    weighted = np.sqrt(normalised)[:, :, None] * offset
    values, vectors = np.linalg.eigh(np.matmul(weighted.transpose(0, 2, 1), weighted))
    return np.maximum(values[:, 0], 0.0), vectors[:, :, 0]


def confidence_of(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    neighbours: Int[np.ndarray, "n k"],
    tolerance: float,
) -> Float[np.ndarray, " n"]:
    """Returns the mean agreement of each point, in height and normal, with its neighbours' tangent planes."""
    closest = neighbours[:, :CONFIDENCE_NEIGHBOURS]
    height = ((points[:, None] - points[closest]) * normals[closest]).sum(axis=2)
    cosine = (normals[:, None] * normals[closest]).sum(axis=2)
    confidence: Float[np.ndarray, " n"] = (np.exp(-0.5 * (height / tolerance) ** 2) * cosine**2).mean(axis=1)
    return confidence


def _is_boundary(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    neighbours: Int[np.ndarray, "n k"],
    distances: Float[np.ndarray, "n k"],
) -> Bool[np.ndarray, " n"]:
    """Returns whether the neighbours of each point lie to one side of it in the tangent plane."""
    shift = points[neighbours].mean(axis=1) - points
    shift -= (shift * normals).sum(axis=1, keepdims=True) * normals
    boundary: Bool[np.ndarray, " n"] = np.linalg.norm(shift, axis=1) > BOUNDARY_SHIFT * distances[:, -1]
    return boundary
