"""Local frames of a surface: its normal and tangents at each point."""

import numpy as np
from jaxtyping import Float, Int


def local_frames(
    points: Float[np.ndarray, "n 3"], neighbours: Int[np.ndarray, "m h"]
) -> tuple[Float[np.ndarray, "m 3"], Float[np.ndarray, "m 3 3"]]:
    """Computes the principal axes of each neighbourhood about its mean.

    Args:
        points: the cloud.
        neighbours: rows of the points of each neighbourhood.

    Returns:
        Variances along the axes, ascending, and the axes in columns. Column 0 is the normal, with an arbitrary sign;
        columns 1 and 2 span the tangent plane.
    """
    around = points[neighbours]
    around = around - around.mean(axis=1, keepdims=True)
    scatter = np.einsum("nhi,nhj->nij", around, around) / neighbours.shape[1]
    return np.linalg.eigh(scatter)


def tangent_frames(normals: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch 3 2"]:
    """Returns two orthonormal tangents, in columns, for each normal of any nonzero length."""
    unit = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    # the coordinate axis at the largest angle to the normal
    axis = np.eye(3)[np.argmin(np.abs(unit), axis=-1)]
    first = np.cross(unit, axis)
    first /= np.linalg.norm(first, axis=-1, keepdims=True)
    return np.stack([first, np.cross(unit, first)], axis=-1)
