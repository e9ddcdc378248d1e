"""One run of a method on a cloud: its detection or its error, and its planes as a ranking."""

from time import perf_counter
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from experiments.baselines.registry import Entry
from experiments.metrics.ranking import Ranking
from symjax import Detection
from symjax.geometry.plane import Plane

LARGEST_RANKING_SCORE = 2.0
"""Upper bound on the ranking scores of symjax's candidates, which no candidate reaches."""


class Attempt(NamedTuple):
    """Outcome of one run of a method on a cloud.

    Attributes:
        detection: what the method returned; None if it raised an exception.
        seconds: run time.
        error: the exception as text; empty if there was none.
    """

    detection: Detection | None
    seconds: float
    error: str = ""


def attempt(entry: Entry, points: Float[np.ndarray, "n 3"], seed: int | list[int] = 0) -> Attempt:
    """Runs a method on a cloud and times it; any exception counts as no answer."""
    start = perf_counter()
    try:
        detection = entry.detect(points, np.random.default_rng(seed))
    except Exception as error:
        return Attempt(None, perf_counter() - start, repr(error))
    return Attempt(detection, perf_counter() - start)


class RankedPlanes(NamedTuple):
    """The candidates of a detection.

    Attributes:
        ranking: the candidates, best first.
        accepted: which of them the method reports as mirror planes.
    """

    ranking: Ranking
    accepted: Bool[np.ndarray, " k"]


def ranked_planes(detection: Detection) -> RankedPlanes:
    """Sorts the candidates of a detection by their ranking scores.

    If the method has a threshold, the candidates that it rejects are ranked behind those that it accepts.
    """
    planes = [candidate.plane for candidate in detection.candidates]
    normals, offsets = (np.array(part, float) for part in zip(*planes, strict=True))
    # unrefined candidates are listed last and must not overtake the refined ones, whatever their score
    scores = np.minimum.accumulate([candidate.ranking_score for candidate in detection.candidates])
    accepted = np.array([any(_same(plane, mirror) for mirror in detection.planes) for plane in planes])
    if detection.threshold is not None:
        scores = np.where(accepted, scores, scores - LARGEST_RANKING_SCORE)
    order = np.argsort(-scores, kind="stable")
    return RankedPlanes(Ranking(normals[order], offsets[order], scores[order]), accepted[order])


def _same(plane: Plane, other: Plane) -> bool:
    return np.array_equal(plane.normal, other.normal) and float(plane.offset) == float(other.offset)
