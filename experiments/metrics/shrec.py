"""PHC and mAP of the SHREC 2023 track "Symmetry detection on point clouds" (Sipiran et al. 2023).

By the organisers' script, as it is published with a participant's code (`evaluation_orig.py` of Shrec2023_PRSNET):
answers by falling confidence; each takes the free truth that is least in a + δ / diagonal among those with
a = 1 − |cos| at most that of 1° and δ, the distance of the answer's point from the true plane, at most 1 % of the
diagonal.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool

from experiments.metrics import matching
from experiments.metrics.prediction import Prediction
from symjax.errors import InvalidArgumentError

COSINE = 1 - np.cos(np.radians(1.0))
"""Largest 1 − |cos| of a match: 1.523e-4."""

DISTANCE = 0.01
"""Largest distance of a match, in diagonals."""


class Scores(NamedTuple):
    """The track's figures.

    Attributes:
        phc: share of shapes whose first answer matches.
        map_of_hits: mean over shapes of the precision at every hit, over the number of hits: the script's mAP. A truth
            that was missed costs nothing.
        map_of_truths: the same sum over the number of truths, so that it does.
    """

    phc: float
    map_of_hits: float
    map_of_truths: float


def hits(prediction: Prediction) -> Bool[np.ndarray, " k"]:
    """Which answers match a truth, best first.

    The point of an answer is the foot of the mean of the points on its plane: the track's answers are (normal, point),
    ours have no point, and up to 1° from the truth the choice moves δ.
    """
    normals, offsets = prediction.answers
    true_normals, true_offsets = prediction.truths
    centre = prediction.case.points.mean(axis=0)
    feet = centre - (normals @ centre - offsets)[:, None] * normals
    angle = 1 - np.abs(normals @ true_normals.T)
    distance = np.abs(feet @ true_normals.T - true_offsets) / prediction.case.diagonal
    matched = (angle <= COSINE) & (distance <= DISTANCE)
    return matching.by_rank(np.where(matched, angle + distance, np.inf)) >= 0


def scores(predictions: Sequence[Prediction]) -> Scores:
    """The figures over all shapes; one without an answer, or without a hit, counts as 0.

    Raises:
        InvalidArgumentError: there are no shapes.
    """
    if not predictions:
        raise InvalidArgumentError("PHC and mAP of no shapes at all: give at least one")
    rows = []
    for one in predictions:
        hit = hits(one)
        precision = np.cumsum(hit) / np.arange(1, len(hit) + 1)
        total = float(precision[hit].sum())
        rows.append((hit[:1].sum(), total / max(hit.sum(), 1), total / max(len(one.case.planes), 1)))
    return Scores(*(float(column) for column in np.mean(rows, axis=0)))
