"""Precision against recall as a threshold on the method's score falls, at fixed limits of angle and offset error.

Unlike a sweep of the limits, this curve shows whether the scores separate correct planes from wrong ones, and it is not
the diagonal when every shape has one true and one predicted plane. It requires scores that are comparable between
shapes.
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
"""Largest angle (degrees) and offset error (diagonals) of a correct plane."""


class Curve(NamedTuple):
    """A curve of precision and recall, with one point per distinct score.

    Attributes:
        scores: thresholds, descending; all planes that score at least the threshold count.
        precision: precision at each threshold.
        recall: recall at each threshold.
    """

    scores: Float[np.ndarray, " m"]
    precision: Float[np.ndarray, " m"]
    recall: Float[np.ndarray, " m"]


def curve(predictions: Sequence[Prediction]) -> Curve:
    """Computes the curve over all shapes from pooled counts; it is empty if no plane was predicted."""
    scores = np.concatenate([np.empty(0), *(prediction.ranking.scores for prediction in predictions)])
    correct = np.concatenate([np.empty(0, bool), *(_correct(prediction) for prediction in predictions)])
    num_truths = sum(len(prediction.case.planes) for prediction in predictions)
    order = np.argsort(-scores, kind="stable")
    hits, scores = np.cumsum(correct[order]), scores[order]
    # planes with equal scores count together, so that their order does not matter
    last = np.flatnonzero(np.append(scores[1:] != scores[:-1], True)[: len(scores)])
    return Curve(scores[last], hits[last] / (last + 1), hits[last] / max(num_truths, 1))


def _correct(prediction: Prediction) -> Bool[np.ndarray, " k"]:
    """Which predicted planes match a true plane; each, best first, takes the free true plane of smallest angle."""
    answers, case = prediction.answers, prediction.case
    cost = np.full((len(answers.offset), len(case.planes)), np.inf)
    for t, truth in enumerate(case.planes):
        angle = np.asarray(deviation_angle(answers.normal, truth.normal))
        offset = np.asarray(offset_error(answers, truth, case.points.mean(axis=0), case.diagonal))
        cost[:, t] = np.where((angle < WITHIN_ANGLE) & (offset < WITHIN_OFFSET), angle, np.inf)
    return matching.by_rank(cost) >= 0
