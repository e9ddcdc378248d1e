"""The asymmetry map: how far every point's mirror image is from the surface, and on which side."""

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane
from symjax.robust.scoring import SLACK
from symjax.robust.surface import estimate_surface


def asymmetry(
    points: Float[np.ndarray, "n 3"], plane: Plane, cloud: Float[np.ndarray, "m 3"]
) -> Float[np.ndarray, " n"]:
    """Signed distances of the points' mirror images from the surface of a cloud.

    Args:
        points: the points that are mirrored; the distance of one that is not finite is NaN.
        plane: the mirror.
        cloud: distinct points of the surface, without outliers; at least nine.

    Returns:
        Distances in the units of the points, along the surface's normal and beyond what the spacing of the cloud
        explains; positive where the image lies on the side of the surface that faces away from the middle of the
        cloud.
    """
    surface = estimate_surface(cloud)
    finite = np.isfinite(points).all(axis=1)
    image = np.asarray(plane.reflect(points[finite]))
    distance, partner = surface.tree.query(image, workers=-1)
    normal = surface.normals[partner]
    outward = ((surface.points[partner] - np.median(cloud, axis=0)) * normal).sum(axis=1)
    height = ((image - surface.points[partner]) * normal).sum(axis=1)
    along = np.sqrt(np.maximum(distance**2 - height**2, 0.0))
    beyond = np.maximum(along - SLACK * surface.spacing, 0.0)
    signed = np.full(len(points), np.nan)
    signed[finite] = np.sign(height) * np.where(outward < 0, -1, 1) * np.hypot(height, beyond)
    return signed
