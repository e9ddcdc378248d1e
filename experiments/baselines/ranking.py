"""What a baseline works on and what it answers: points in a common frame, ranked planes with scores."""

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
    offsets: Float[np.ndarray, "k"]
    scores: Float[np.ndarray, "k"]

    def plane(self, k: int = 0) -> Plane:
        """The k-th best plane."""
        return Plane(self.normals[k], self.offsets[k])


class Frame(NamedTuple):
    """A cloud about its mean, in units of its mean radius, thinned at random.

    Attributes:
        points: at most so many points, of mean radius about 1.
        centre: mean of all points, in their own units.
        length: mean distance of all points from it: the unit.
    """

    points: Float[np.ndarray, "m 3"]
    centre: Float[np.ndarray, "3"]
    length: float

    def ranking(
        self,
        normals: Float[np.ndarray, "k 3"],
        offsets: Float[np.ndarray, "k"],
        scores: Float[np.ndarray, "k"],
    ) -> Ranking:
        """Planes of this frame as a ranking in the units of the points: sorted by falling score, signs canonical."""
        order = np.argsort(-np.asarray(scores), kind="stable")
        plane = Plane(normals[order], self.length * offsets[order] + normals[order] @ self.centre).canonical()
        return Ranking(np.asarray(plane.normal), np.asarray(plane.offset), np.asarray(scores)[order])


def framed(points: Float[np.ndarray, "n 3"], rng: np.random.Generator, *, most: int = 5000) -> Frame:
    """The frame of a cloud."""
    centre = points.mean(axis=0)
    length = float(np.linalg.norm(points - centre, axis=1).mean())
    kept = points if len(points) <= most else points[rng.permutation(len(points))[:most]]
    return Frame((kept - centre) / length, centre, length)


def reflect(
    normal: Float[np.ndarray, "3"], offset: float, points: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n 3"]:
    """Mirror images x − 2(n·x − w)n."""
    return points - 2 * np.outer(points @ normal - offset, normal)


def plane_distance(
    normals: Float[np.ndarray, "k 3"], offsets: Float[np.ndarray, "k"], normal: Float[np.ndarray, "3"], offset: float
) -> Float[np.ndarray, "k"]:
    """D(p, q) = min(|p − q|, |p + q|) over the 4-vectors (n, w), w in units of the mean radius."""
    rows, row = np.column_stack([normals, offsets]), np.append(normal, offset)
    return np.minimum(np.linalg.norm(rows - row, axis=1), np.linalg.norm(rows + row, axis=1))


def distinct(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, "k"],
    scores: Float[np.ndarray, "k"],
    *,
    apart: float,
    most: int,
) -> Int[np.ndarray, "j"]:
    """Indices of the best planes, best first, none within `apart` (see `plane_distance`) of a better one."""
    kept: list[int] = []
    for k in np.argsort(-scores, kind="stable"):
        if len(kept) == most:
            break
        if not kept or (plane_distance(normals[kept], offsets[kept], normals[k], offsets[k]) >= apart).all():
            kept.append(int(k))
    return np.asarray(kept, int)
