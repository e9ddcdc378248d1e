"""Symmetry distance error (SDE) of PRS-Net (Gao et al., TVCG 2020): how far mirror images are from the surface.

By its `evaluation.m`: 1 000 points uniform by area are reflected, and their squared distances to the triangles
averaged, in the units of ShapeNetCore.v2, where the bounding box has diagonal 1. Here the distances are to a dense
sample of the surface, and divided by the squared diagonal.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from symjax.geometry.plane import Plane

NUM_SAMPLES = 1000
"""Points that are reflected."""


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
