"""Ranked planes, and how far planes are apart as 4-vectors."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane


class Ranking(NamedTuple):
    """The planes that a method proposes, best first.

    Attributes:
        normals: unit normals, each with its largest component positive.
        offsets: normal · x = offset, in the units of the points.
        scores: the method's own score, falling; no scale is shared between methods.
    """

    normals: Float[np.ndarray, "k 3"]
    offsets: Float[np.ndarray, " k"]
    scores: Float[np.ndarray, " k"]

    def plane(self, k: int = 0) -> Plane:
        """The k-th best plane."""
        return Plane(self.normals[k], self.offsets[k])


def plane_distance(planes: Plane, plane: Plane) -> Float[np.ndarray, " k"]:
    """D(p, q) = min(|p − q|, |p + q|) over the 4-vectors (n, w), w in the units of the frame."""
    rows, row = np.column_stack([*planes]), np.append(*plane)
    return np.minimum(np.linalg.norm(rows - row, axis=1), np.linalg.norm(rows + row, axis=1))


def distinct(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    scores: Float[np.ndarray, " k"],
    *,
    apart: float,
    most: int,
) -> Int[np.ndarray, " j"]:
    """Indices of the best planes, best first, none within `apart` (see `plane_distance`) of a better one."""
    kept: list[int] = []
    for k in np.argsort(-scores, kind="stable"):
        if len(kept) == most:
            break
        better = Plane(normals[kept], offsets[kept])
        if (plane_distance(better, Plane(normals[k], offsets[k])) >= apart).all():
            kept.append(k)
    return np.asarray(kept, int)
