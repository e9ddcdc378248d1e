"""What speaks for a plane and against it: exact neighbours of the mirrored cloud.

A point whose mirror image lies on the surface, with the surface's normal, speaks for the plane. One whose image lies
where a surface would have been seen speaks against it; one whose image falls where nothing was scanned says little.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.robust.quadrics import Patches, heights
from symjax.robust.surface import Surface
from symjax.robust.voxel_grid import Lattice, blame_at

TOLERANCES = 1.4
"""Scale of the height above the partner's tangent plane in the surface's tolerances."""

SLACK = 2.0
"""Distance along the tangent plane in spacings that a random sample explains."""

EXACT, LEAST_SCATTER = 2.0, 1e-5
"""Standard deviations of the surface's own scatter (at least LEAST_SCATTER diagonals) within which an image fits
exactly."""

FAR = 2.0
"""Distance of a mirror image from its point in spacings at which it counts: one on the plane agrees with any plane."""


class Evidence(NamedTuple):
    """Of some points of a surface, for one plane.

    Attributes:
        partner: row of the surface point nearest to each mirror image.
        share: how well the image agrees with it, 0 to 1.
        counts: how much each point tells at all.
        blame: how much it tells against the plane if it does not agree.
    """

    partner: Int[np.ndarray, "m"]
    share: Float[np.ndarray, "m"]
    counts: Float[np.ndarray, "m"]
    blame: Float[np.ndarray, "m"]

    @property
    def score(self) -> float:
        """Support over support and blame, 0 to 1."""
        return self.score_of(self.share)

    def score_of(self, share: Float[np.ndarray, "m"]) -> float:
        """The score that other shares give."""
        support = float((self.counts * share).sum())
        return support / (support + float((self.counts * (1 - share) * self.blame).sum()) + 1e-12)


def evidence(
    plane: Plane, surface: Surface, lattice: Lattice, rows: Int[np.ndarray, "m"] | slice = slice(None)
) -> Evidence:
    """Looks at the mirror images of some rows of a surface."""
    points, normals = surface.points[rows], surface.normals[rows]
    height = points @ plane.normal - plane.offset
    image = points - 2 * height[:, None] * plane.normal
    distance, partner = surface.tree.query(image, workers=-1)
    theirs = surface.normals[partner]
    above = ((image - surface.points[partner]) * theirs).sum(axis=1)
    along = np.sqrt(np.maximum(distance**2 - above**2, 0.0))
    facing = normals - 2 * (normals @ plane.normal)[:, None] * plane.normal
    cosine = (facing * theirs).sum(axis=1)
    off = (above / (TOLERANCES * surface.tolerance)) ** 2
    off += (np.maximum(along - SLACK * surface.spacing, 0.0) / surface.spacing) ** 2
    counts = surface.trust[rows] * (1 - np.exp(-2 * (height / (FAR * surface.spacing)) ** 2))
    return Evidence(partner, np.exp(-0.5 * off) * cosine**2, counts, blame_at(lattice, image))


def exactness(plane: Plane, surface: Surface, found: Evidence, around: Patches) -> float:
    """The score where only images that lie as close to the surface as its own points do speak for the plane.

    Measured: from about 0.5 to 1 where the symmetry is exact; where there is none, below 0.5 on clean clouds and below
    0.65 on noisy ones.

    Args:
        plane: the plane.
        surface: the cloud.
        found: what all its points say.
        around: its patches.
    """
    image = np.asarray(plane.reflect(surface.points))
    near = np.abs(heights(image, around, found.partner)) < EXACT * max(around.scatter, LEAST_SCATTER)
    return found.score_of(near.astype(float))
