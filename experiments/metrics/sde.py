"""Symmetry distance error (SDE) of PRS-Net (Gao et al., TVCG 2020): how far mirror images are from the surface.

By its `evaluation.m`: 1 000 points uniform by area are reflected, and their squared distances to the triangles
averaged; a table's figure is the mean over all planes whose SDE is above 0, not over shapes. It is in the units of
ShapeNetCore.v2, where the bounding box has diagonal 1: here it is divided by the squared diagonal instead. The
published code reflects by the plane as it is stored; a `Plane` has a unit normal.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.metrics.distance import squared_distances
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.io.mesh import Mesh, sample

NUM_SAMPLES = 1000
"""Points that are reflected."""


def sde(plane: Plane, mesh: Mesh, rng: np.random.Generator, *, num_samples: int = NUM_SAMPLES) -> float:
    """SDE of a plane on a mesh, in squared diagonals.

    Args:
        plane: in the frame of the mesh.
        mesh: with triangles.
        rng: of the samples; the same state gives all planes of a shape the same ones.
        num_samples: points that are reflected.

    Raises:
        InvalidArgumentError: the mesh has no triangle with an area.
        FileFormatError: vertices are not finite.
    """
    diagonal = float(np.linalg.norm(np.ptp(mesh.vertices[mesh.triangles].reshape(-1, 3), axis=0)))
    images = np.asarray(plane.reflect(sample(mesh, num_samples, rng)))
    return float(squared_distances(images, mesh).mean()) / diagonal**2


def cloud_sde(
    plane: Plane, points: Float[np.ndarray, "n 3"], dense: Float[np.ndarray, "m 3"], diagonal: float
) -> float:
    """SDE of a plane where only points are known: against a dense sample, less what the spacing of that sample makes.

    The mean of d²(reflected point, sample) − d²(point, sample). The second term is what a perfect plane would get; for
    one the difference scatters about 0, and may be negative.

    Args:
        plane: in the frame of the points.
        points: a random sample of the surface, none of them among `dense`.
        dense: another one, of 30 000 points or more: a coarser one hides small errors.
        diagonal: of the object's bounding box, in the units of the points.
    """
    tree = KDTree(dense)
    reflected, base = (tree.query(p)[0] ** 2 for p in (plane.reflect(points), points))
    return float((reflected - base).mean()) / diagonal**2


def mean_sde(values: Sequence[float]) -> float:
    """A table's figure: the mean over all planes of all shapes that are above 0.

    Raises:
        InvalidArgumentError: none is.
    """
    positive = [value for value in values if value > 0]
    if not positive:
        raise InvalidArgumentError(f"no SDE above 0 among {len(values)}")
    return float(np.mean(positive))
