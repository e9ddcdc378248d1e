"""The frame that baselines work in: its origin is the mean of the cloud, and its unit is the mean radius."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity


class Frame(NamedTuple):
    """A cloud relative to its mean, in units of its mean radius, thinned at random.

    Attributes:
        points: points that were kept.
        to_given: similarity from this frame to that of the input points.
    """

    points: Float[np.ndarray, "m 3"]
    to_given: Similarity

    def ranking(
        self,
        normals: Float[np.ndarray, "k 3"],
        offsets: Float[np.ndarray, " k"],
        scores: Float[np.ndarray, " k"],
    ) -> Ranking:
        """Sorts planes of this frame by falling score, and returns them in the frame and units of the input points."""
        order = np.argsort(-np.asarray(scores), kind="stable")
        plane = self.to_given.plane(Plane(normals[order], offsets[order])).canonical()
        return Ranking(np.asarray(plane.normal), np.asarray(plane.offset), np.asarray(scores)[order])


def make_frame(points: Float[np.ndarray, "n 3"], rng: np.random.Generator, *, max_points: int = 5000) -> Frame:
    """Moves a cloud to its mean, scales it to mean radius 1, and keeps at most `max_points` random points of it."""
    centre = points.mean(axis=0)
    length = float(np.linalg.norm(points - centre, axis=1).mean())
    kept = points if len(points) <= max_points else points[rng.permutation(len(points))[:max_points]]
    return Frame((kept - centre) / length, Similarity(length, None, centre))


def reflect(
    normal: Float[np.ndarray, " 3"], offset: float, points: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n 3"]:
    """Reflects points in a plane; `Plane.reflect` with NumPy arguments."""
    return np.asarray(Plane(normal, np.asarray(offset)).reflect(points))
