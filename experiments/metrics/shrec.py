"""PHC and mAP of the SHREC 2023 track "Symmetry detection on point clouds" (Sipiran et al. 2023).

As in the organisers' script, which is published with a participant's code (`evaluation_orig.py` of Shrec2023_PRSNET):
predicted planes are processed in order of falling confidence. Let a = 1 − |cos| of the angle between the normals, and δ
the distance of the predicted plane's point from the true plane. Each predicted plane takes the free true plane with the
smallest a + δ / diagonal, among those where the angle is at most 1° and δ at most 1 % of the diagonal.
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
    """Scores of the track.

    Attributes:
        phc: share of shapes whose best predicted plane matches.
        map_of_hits: mAP as in the script: for each shape the sum of the precision at every hit, divided by the number
            of hits; then the mean over shapes. Missed true planes do not lower it.
        map_of_truths: mAP with division by the number of true planes instead, so that missed planes do lower it.
    """

    phc: float
    map_of_hits: float
    map_of_truths: float


def hits(prediction: Prediction) -> Bool[np.ndarray, " k"]:
    """Returns which predicted planes match a true plane, best first.

    The track represents planes as (normal, point). Ours have no point, so we use the projection of the cloud's mean
    onto the plane; the choice affects δ if the normals differ, by up to 1°.
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
    """Computes the scores over all shapes; a shape without a predicted plane or without a hit counts as 0.

    Raises:
        InvalidArgumentError: if there are no shapes.
    """
    if not predictions:
        raise InvalidArgumentError("the list of predictions is empty: PHC and mAP need at least one shape")
    rows = []
    for prediction in predictions:
        hit = hits(prediction)
        precision = np.cumsum(hit) / np.arange(1, len(hit) + 1)
        total = float(precision[hit].sum())
        rows.append((hit[:1].sum(), total / max(hit.sum(), 1), total / max(len(prediction.case.planes), 1)))
    return Scores(*(float(column) for column in np.mean(rows, axis=0)))
