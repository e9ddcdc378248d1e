"""The score of a plane on the cloud itself: every mirror image is compared with its exact nearest neighbour.

A point whose mirror image lies on the surface and has the surface's normal agrees with the plane. A point whose image
lies where a scan would have seen a surface counts against the plane; one whose image falls where nothing was scanned
hardly counts.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.robust.quadrics import Quadrics
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import VoxelGrid, penalty_at

TOLERANCES = 1.4
"""Scale of the height above the partner's tangent plane in the surface's tolerances."""

SLACK = 2.0
"""Distance along the tangent plane in spacings that a random sample explains."""

EXACT, LEAST_SCATTER = 2.0, 1e-5
"""Standard deviations of the surface's own scatter (at least LEAST_SCATTER diagonals) within which an image fits
exactly."""

FAR = 2.0
"""Distance of a mirror image from its point in spacings at which it counts: one on the plane agrees with any plane."""


class PlaneScore(NamedTuple):
    """How some points of a surface agree with a plane.

    Attributes:
        partner: row of the surface point nearest to each mirror image.
        agreement: how well the image agrees with its partner in place and normal, 0 to 1.
        weight: how much each point counts.
        penalty: non-match penalty, 0 to 1: how much a point counts against the plane where its image does not agree.
    """

    partner: Int[np.ndarray, " m"]
    agreement: Float[np.ndarray, " m"]
    weight: Float[np.ndarray, " m"]
    penalty: Float[np.ndarray, " m"]

    @property
    def score(self) -> float:
        """The sum of the agreement over the sum of agreement and non-match penalty, weighted; 0 to 1."""
        return self.score_of(self.agreement)

    def score_of(self, agreement: Float[np.ndarray, " m"]) -> float:
        """The score for another agreement of the same points."""
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
    """Reflects the selected points and scores how well they fit the surface.

    Args:
        plane: the plane.
        surface: in units of its diagonal.
        grid: around it; it holds the non-match penalty.
        rows: the points that are mirrored.
        use_normals: whether the normals must agree too.
    """
    points = surface.points[rows]
    height, image = np.asarray(plane.signed_distance(points)), np.asarray(plane.reflect(points))
    distance, partner = surface.tree.query(image, workers=-1)
    normals = surface.normals[partner]
    above = ((image - surface.points[partner]) * normals).sum(axis=1)
    along = np.sqrt(np.maximum(distance**2 - above**2, 0.0))
    off = (above / (TOLERANCES * surface.tolerance)) ** 2
    off += (np.maximum(along - SLACK * surface.spacing, 0.0) / surface.spacing) ** 2
    agreement = np.exp(-0.5 * off)
    if use_normals:
        mirrored = np.asarray(plane.reflect_directions(surface.normals[rows]))
        agreement = agreement * (mirrored * normals).sum(axis=1) ** 2
    weight = surface.confidence[rows] * (1 - np.exp(-2 * (height / (FAR * surface.spacing)) ** 2))
    return PlaneScore(partner, agreement, weight, penalty_at(grid, image))


def exactness(plane: Plane, surface: Surface, scored: PlaneScore, quadrics: Quadrics) -> float:
    """The score if only images agree that lie as close to the surface as its own points do.

    Measured: from about 0.5 to 1 where the symmetry is exact; where there is none, below 0.5 on clean clouds and below
    0.65 on noisy ones.

    Args:
        plane: the plane.
        surface: the cloud.
        scored: the plane's score on all points of the surface.
        quadrics: of the surface.
    """
    image = np.asarray(plane.reflect(surface.points))
    near = np.abs(quadrics.heights(image, scored.partner)) < EXACT * max(quadrics.scatter, LEAST_SCATTER)
    return scored.score_of(near.astype(float))
