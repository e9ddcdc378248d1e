"""What a method makes of a cloud: a detection or an error, and its planes as a ranking."""

from time import perf_counter
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from experiments.baselines.registry import Entry
from experiments.metrics.ranking import Ranking
from symjax import Detection
from symjax.geometry.plane import Plane

LARGEST_RANKING_SCORE = 2.0
"""No candidate of symjax has as much."""


class Attempt(NamedTuple):
    """What a method makes of a cloud.

    Attributes:
        detection: its answer; None where it raised.
        seconds: that it took.
        error: what it raised.
    """

    detection: Detection | None
    seconds: float
    error: str = ""


def attempt(entry: Entry, points: Float[np.ndarray, "n 3"], seed: int | list[int] = 0) -> Attempt:
    """Lets a method try a cloud. One that raises has given no answer, whatever it raises."""
    start = perf_counter()
    try:
        detection = entry.detect(points, np.random.default_rng(seed))
    except Exception as error:
        return Attempt(None, perf_counter() - start, repr(error))
    return Attempt(detection, perf_counter() - start)


class RankedPlanes(NamedTuple):
    """All planes that a method looked at in the end.

    Attributes:
        ranking: the best first.
        held: which of them the method takes for mirror planes.
    """

    ranking: Ranking
    held: Bool[np.ndarray, " k"]


def ranked_planes(detection: Detection) -> RankedPlanes:
    """The candidates of a detection by their ranking scores.

    A method that can doubt, since its planes have to exceed a threshold, ranks the others behind its mirror planes.
    """
    planes = [candidate.plane for candidate in detection.candidates]
    normals, offsets = (np.array(part, float) for part in zip(*planes, strict=True))
    # a candidate that was not refined stands behind those that were, whatever its score
    scores = np.minimum.accumulate([candidate.ranking_score for candidate in detection.candidates])
    held = np.array([any(_same(plane, mirror) for mirror in detection.planes) for plane in planes])
    if detection.threshold is not None:
        scores = np.where(held, scores, scores - LARGEST_RANKING_SCORE)
    order = np.argsort(-scores, kind="stable")
    return RankedPlanes(Ranking(normals[order], offsets[order], scores[order]), held[order])


def _same(plane: Plane, other: Plane) -> bool:
    return np.array_equal(plane.normal, other.normal) and float(plane.offset) == float(other.offset)
