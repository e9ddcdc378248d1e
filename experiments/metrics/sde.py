"""Symmetry distance error (SDE) of PRS-Net (Gao et al., TVCG 2020): squared distance of mirror images to the surface.

PRS-Net's `evaluation.m` reflects 1 000 points, sampled uniformly by area, and averages their squared distances to the
triangles, in the units of ShapeNetCore.v2, where the bounding box has diagonal 1. Here the distances are to a dense
sample of the surface and are divided by the squared diagonal.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from symjax.geometry.plane import Plane

NUM_SAMPLES = 1000
"""Number of points that are reflected."""


def cloud_sde(
    plane: Plane, points: Float[np.ndarray, "n 3"], dense: Float[np.ndarray, "m 3"], diagonal: float
) -> float:
    """Computes the SDE of a plane from points only, against a dense sample of the surface.

    The SDE is the mean of d²(reflected point, sample) − d²(point, sample). The second term corrects for the spacing of
    the sample: it is what an exact plane would get. For an exact plane the difference scatters about 0 and may be
    negative.

    Args:
        plane: plane in the frame of the points.
        points: random sample of the surface that shares no point with `dense`.
        dense: another sample of the surface; fewer than 30 000 points would hide small errors.
        diagonal: diagonal of the object's bounding box, in the units of the points.
    """
    tree = KDTree(dense)
    reflected, base = (tree.query(p)[0] ** 2 for p in (plane.reflect(points), points))
    return float((reflected - base).mean()) / diagonal**2
