"""The frame that baselines work in: about the mean of a cloud, in units of its mean radius."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity


class Frame(NamedTuple):
    """A cloud about its mean, in units of its mean radius, thinned at random.

    Attributes:
        points: at most so many points, of mean radius about 1.
        to_given: the way back to the units of the points.
    """

    points: Float[np.ndarray, "m 3"]
    to_given: Similarity

    def ranking(
        self,
        normals: Float[np.ndarray, "k 3"],
        offsets: Float[np.ndarray, " k"],
        scores: Float[np.ndarray, " k"],
    ) -> Ranking:
        """Planes of this frame as a ranking in the units of the points: sorted by falling score, signs canonical."""
        order = np.argsort(-np.asarray(scores), kind="stable")
        plane = self.to_given.plane(Plane(normals[order], offsets[order])).canonical()
        return Ranking(np.asarray(plane.normal), np.asarray(plane.offset), np.asarray(scores)[order])


def framed(points: Float[np.ndarray, "n 3"], rng: np.random.Generator, *, most: int = 5000) -> Frame:
    """The frame of a cloud."""
    centre = points.mean(axis=0)
    length = float(np.linalg.norm(points - centre, axis=1).mean())
    kept = points if len(points) <= most else points[rng.permutation(len(points))[:most]]
    return Frame((kept - centre) / length, Similarity(length, None, centre))


def reflect(
    normal: Float[np.ndarray, " 3"], offset: float, points: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, "n 3"]:
    """Mirror images of points, see `Plane.reflect`."""
    return np.asarray(Plane(normal, np.asarray(offset)).reflect(points))
