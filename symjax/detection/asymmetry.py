"""The asymmetry map: signed distance of every mirror image from the surface."""

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane
from symjax.preprocess.cloud_frame import to_cloud_frame
from symjax.preprocess.flatness import is_flat
from symjax.robust.sheet import find_sheet
from symjax.robust.surface import Surface, estimate_surface
from symjax.robust.verification.scoring import SLACK


def asymmetry(
    points: Float[np.ndarray, "n 3"], plane: Plane, cloud: Float[np.ndarray, "m 3"]
) -> Float[np.ndarray, " n"]:
    """Computes the signed distances of the points' mirror images from the surface of a cloud.

    The distance has two parts: the height above the surface along its normal, and the distance along the surface
    to the nearest point of the cloud, less what the spacing of the cloud explains. If the cloud is flat, both are
    measured in its sheet; mirror images within the outline of a filled sheet have the distance 0.

    Args:
        points: the points to reflect.
        plane: the mirror plane.
        cloud: distinct points of the surface, without outliers; at least nine.

    Returns:
        Distances in the units of the points. They are positive where the mirror image lies outside the surface, on
        the side that faces away from the centre of the cloud, and NaN for points that are not finite.
    """
    finite = np.isfinite(points).all(axis=1)
    image = np.asarray(plane.reflect(points[finite]))
    signed = np.full(len(points), np.nan)
    own = to_cloud_frame(cloud)
    if is_flat(own.points):
        sheet = find_sheet(own.points)
        in_sheet = np.asarray(own.to_given.inverse().points(image)) * np.array([1.0, 1.0, 0.0])
        signed[finite] = own.to_given.scale * _signed_distance(in_sheet, sheet.whole, filled=sheet.filled)
    else:
        signed[finite] = _signed_distance(image, estimate_surface(cloud))
    return signed


def _signed_distance(
    image: Float[np.ndarray, "n 3"], surface: Surface, *, filled: bool = False
) -> Float[np.ndarray, " n"]:
    """Returns the signed distances of mirror images from a surface; of a filled sheet, those beyond its outline."""
    distance, partner = surface.tree.query(image, workers=-1)
    if filled:
        outside: Float[np.ndarray, " n"] = np.maximum(distance - SLACK * surface.spacing, 0.0)
        return outside
    normal = surface.normals[partner]
    outward = ((surface.points[partner] - np.median(surface.points, axis=0)) * normal).sum(axis=1)
    height = ((image - surface.points[partner]) * normal).sum(axis=1)
    along = np.sqrt(np.maximum(distance**2 - height**2, 0.0))
    beyond = np.maximum(along - SLACK * surface.spacing, 0.0)
    signed: Float[np.ndarray, " n"] = np.sign(height) * np.where(outward < 0, -1, 1) * np.hypot(height, beyond)
    return signed
