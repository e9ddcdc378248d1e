"""The asymmetry map: signed distance of every mirror image from the surface."""

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.scoring import SLACK


def asymmetry(
    points: Float[np.ndarray, "n 3"], plane: Plane, cloud: Float[np.ndarray, "m 3"]
) -> Float[np.ndarray, " n"]:
    """Computes the signed distances of the points' mirror images from the surface of a cloud.

    The distance has two parts: the height above the surface along its normal, and the distance along the surface
    to the nearest point of the cloud, less what the spacing of the cloud explains.

    Args:
        points: the points to reflect.
        plane: the mirror plane.
        cloud: distinct points of the surface, without outliers; at least nine.

    Returns:
        Distances in the units of the points. They are positive where the mirror image lies outside the surface, on
        the side that faces away from the centre of the cloud, and NaN for points that are not finite.
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
