"""Ranked planes, and the distance of planes as 4-vectors."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane


class Ranking(NamedTuple):
    """The planes that a method predicts, best first.

    Attributes:
        normals: unit normals, each with its largest component positive.
        offsets: offsets of the planes normal · x = offset, in the units of the points.
        scores: scores of the method, descending; they are not comparable between methods.
    """

    normals: Float[np.ndarray, "k 3"]
    offsets: Float[np.ndarray, " k"]
    scores: Float[np.ndarray, " k"]

    def plane(self, k: int = 0) -> Plane:
        """Returns the plane at index k, 0 being the best."""
        return Plane(self.normals[k], self.offsets[k])


def plane_distance(planes: Plane, plane: Plane) -> Float[np.ndarray, " k"]:
    """Computes min(|p − q|, |p + q|) of the 4-vectors (n, ω) of each plane p and the plane q, in the units of ω."""
    p, q = np.column_stack([*planes]), np.append(*plane)
    distance: Float[np.ndarray, " k"] = np.minimum(np.linalg.norm(p - q, axis=1), np.linalg.norm(p + q, axis=1))
    return distance


def distinct(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    scores: Float[np.ndarray, " k"],
    *,
    apart: float,
    most: int,
) -> Int[np.ndarray, " j"]:
    """Selects the best planes that are at least a distance apart from all better ones (non-maximum suppression).

    Args:
        normals: unit normals.
        offsets: offsets of the planes.
        scores: scores, in any order.
        apart: least `plane_distance` between selected planes.
        most: largest number of selected planes.

    Returns:
        Indices of the selected planes, best first.
    """
    kept: list[int] = []
    for k in np.argsort(-scores, kind="stable"):
        if len(kept) == most:
            break
        better = Plane(normals[kept], offsets[kept])
        if (plane_distance(better, Plane(normals[k], offsets[k])) >= apart).all():
            kept.append(k)
    return np.asarray(kept, int)
