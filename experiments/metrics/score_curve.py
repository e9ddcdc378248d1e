"""Precision against recall as a threshold on the method's own score falls, at fixed limits of angle and offset.

Unlike the sweep of the limits it says whether the scores tell right answers from wrong ones, and it does not collapse
to the diagonal where every shape has one truth and one answer. It needs scores that are comparable between shapes.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from experiments.metrics import matching
from experiments.metrics.prediction import Prediction
from symjax.geometry.directions import deviation_angle
from symjax.geometry.distance import offset_error

WITHIN_ANGLE, WITHIN_OFFSET = 5.0, 0.01
"""Largest angle (degrees) and distance (diagonals) of a right answer."""


class Curve(NamedTuple):
    """A point for each distinct score, the highest first: what counts is every answer that scores at least as much."""

    scores: Float[np.ndarray, " m"]
    precision: Float[np.ndarray, " m"]
    recall: Float[np.ndarray, " m"]


def curve(predictions: Sequence[Prediction]) -> Curve:
    """The curve over all shapes, counts pooled; empty where nothing was predicted."""
    scores = np.concatenate([np.empty(0), *(one.ranking.scores for one in predictions)])
    right = np.concatenate([np.empty(0, bool), *(_right(one) for one in predictions)])
    num_truths = sum(len(one.case.planes) for one in predictions)
    order = np.argsort(-scores, kind="stable")
    hits, scores = np.cumsum(right[order]), scores[order]
    # ties come in or stay out together: their order must not matter
    last = np.flatnonzero(np.append(scores[1:] != scores[:-1], True)[: len(scores)])
    return Curve(scores[last], hits[last] / (last + 1), hits[last] / max(num_truths, 1))


def _right(prediction: Prediction) -> Bool[np.ndarray, " k"]:
    """Which answers are matched to a truth, one to one, best first, the nearest in angle."""
    answers, case = prediction.answers, prediction.case
    cost = np.full((len(answers.offset), len(case.planes)), np.inf)
    for t, truth in enumerate(case.planes):
        angle = np.asarray(deviation_angle(answers.normal, truth.normal))
        offset = np.asarray(offset_error(answers, truth, case.points.mean(axis=0), case.diagonal))
        cost[:, t] = np.where((angle < WITHIN_ANGLE) & (offset < WITHIN_OFFSET), angle, np.inf)
    return matching.by_rank(cost) >= 0
