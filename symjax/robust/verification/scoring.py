"""Scoring: how well the reflected cloud matches the cloud, with exact nearest neighbours.

The partner of a point is the surface point nearest to its mirror image. A point supports the plane if its mirror image
agrees with the partner in place and in normal direction. Otherwise it counts against the plane, by the non-match
penalty of the mirror image: fully where a scan would have seen a surface, hardly at all where nothing was scanned.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.robust.quadrics import Quadrics
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import VoxelGrid, penalty_at

HEIGHT_SCALE = 1.4
"""Height of a mirror image above its partner's tangent plane at which the agreement falls to exp(−½), in tolerances of
the surface."""

SLACK = 2.0
"""Distance along the tangent plane, in spacings, that does not reduce the agreement: random sampling explains it."""

EXACT_HEIGHT, MIN_SCATTER = 2.0, 1e-5
"""A mirror image matches exactly if its height above the partner's quadric is less than EXACT_HEIGHT standard
deviations of the surface's own scatter, which counts as at least MIN_SCATTER diagonals."""

DISPLACEMENT_SCALE = 2.0
"""Distance between a point and its mirror image, in spacings, at which the weight of the point reaches 1 − exp(−½). A
point on the plane is its own mirror image and agrees with every plane through it."""


class PlaneScore(NamedTuple):
    """How well points of a surface agree with a plane.

    Attributes:
        partner: row of the surface point nearest to each mirror image.
        distance: distance of that point.
        agreement: how well each mirror image agrees with its partner in place and normal direction, 0 to 1.
        weight: weight of each point.
        penalty: non-match penalty of each mirror image, 0 to 1.
    """

    partner: Int[np.ndarray, " m"]
    distance: Float[np.ndarray, " m"]
    agreement: Float[np.ndarray, " m"]
    weight: Float[np.ndarray, " m"]
    penalty: Float[np.ndarray, " m"]

    @property
    def score(self) -> float:
        """The score Σwa / (Σwa + Σw(1 − a)p), 0 to 1, of weights w, agreements a and non-match penalties p."""
        return self.score_of(self.agreement)

    def score_of(self, agreement: Float[np.ndarray, " m"]) -> float:
        """Returns the score that the same points have with another agreement."""
        agreeing = float((self.weight * agreement).sum())
        return agreeing / (agreeing + float((self.weight * (1 - agreement) * self.penalty).sum()) + 1e-12)


def score_plane(
    plane: Plane,
    surface: Surface,
    grid: VoxelGrid,
    rows: Int[np.ndarray, " m"] | slice = slice(None),
    *,
    use_normals: bool = True,
) -> PlaneScore:
    """Reflects points of a surface in a plane and scores how well they match the surface.

    Args:
        plane: the plane.
        surface: the surface, in units of its diagonal.
        grid: the voxel grid around it, which holds the non-match penalty.
        rows: the points that are reflected.
        use_normals: whether the agreement includes the normal direction.

    Returns:
        The score, with the agreement of every reflected point.
    """
    points = surface.points[rows]
    image = np.asarray(plane.reflect(points))
    distance, partner = surface.tree.query(image, workers=-1)
    normals = surface.normals[partner]
    above = ((image - surface.points[partner]) * normals).sum(axis=1)
    along = np.sqrt(np.maximum(distance**2 - above**2, 0.0))
    squared = (above / (HEIGHT_SCALE * surface.tolerance)) ** 2
    squared += (np.maximum(along - SLACK * surface.spacing, 0.0) / surface.spacing) ** 2
    agreement = np.exp(-0.5 * squared)
    if use_normals:
        reflected = np.asarray(plane.reflect_directions(surface.normals[rows]))
        agreement = agreement * (reflected * normals).sum(axis=1) ** 2
    weight = surface.confidence[rows] * displacement_weight(plane, points, surface.spacing)
    return PlaneScore(partner, distance, agreement, weight, penalty_at(grid, image))


def displacement_weight(plane: Plane, points: Float[np.ndarray, "n 3"], spacing: float) -> Float[np.ndarray, " n"]:
    """Returns the weight of points by the distance from their mirror images, from 0 on the plane to 1 far from it."""
    height = np.asarray(plane.signed_distance(points))
    return 1 - np.exp(-2 * (height / (DISPLACEMENT_SCALE * spacing)) ** 2)


def exactness(plane: Plane, surface: Surface, scored: PlaneScore, quadrics: Quadrics) -> float:
    """Returns the exactness: the score if only mirror images agree that lie as close to the surface as its own points.

    Measured: about 0.5 to 1 for an exact symmetry; without a symmetry, below 0.5 on clean clouds and below 0.65 on
    noisy ones.

    Args:
        plane: the plane.
        surface: the surface, in units of its diagonal.
        scored: score of the plane on all points of the surface.
        quadrics: the quadrics of the surface.
    """
    image = np.asarray(plane.reflect(surface.points))
    exact = np.abs(quadrics.heights(image, scored.partner)) < EXACT_HEIGHT * max(quadrics.scatter, MIN_SCATTER)
    return scored.score_of(exact.astype(float))
