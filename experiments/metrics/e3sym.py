"""The F-score of E3Sym (Li et al., ICCV 2023), averaged over thresholds on the distance of planes as 4-vectors.

Answers and truths are matched one to one, nearest pairs first, and counts are pooled over the data set: so does the
public script `evaluate_official_benchmark.m` of prsnet-repro. Another public script (`metric_F1.py` of
EnhancedBackProjection) uses the four thresholds `COARSE`, counts every pair that does not match as a false answer and
lets one answer match several truths: its counts are not reproduced here, only its thresholds.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from experiments.metrics import matching
from experiments.metrics.matching import Tally
from experiments.metrics.prediction import Prediction
from experiments.metrics.ranking import plane_distance
from symjax.geometry.plane import Plane

FINE = np.linspace(0.0, 0.2, 201)
"""Thresholds of prsnet-repro."""

COARSE = np.array([0.05, 0.1, 0.15, 0.2])
"""Thresholds of Aguirre and Sipiran (WACV 2026)."""


def tallies(predictions: Sequence[Prediction], thresholds: np.ndarray = FINE) -> list[Tally]:
    """Pooled counts at every threshold; a match is nearer than the threshold.

    Args:
        predictions: all shapes, also those without an answer or without a truth.
        thresholds: largest distances of a match.
    """
    found = [matching.by_cost(_distances(one)) for one in predictions]
    distances = np.sort(np.concatenate(found)) if found else np.empty(0)
    num_answers = sum(len(one.ranking.offsets) for one in predictions)
    num_truths = sum(len(one.case.planes) for one in predictions)
    hits = np.searchsorted(distances, thresholds, side="left")
    return [Tally(int(count), num_answers, num_truths) for count in hits]


def f_score(predictions: Sequence[Prediction], thresholds: np.ndarray = FINE) -> float:
    """Mean of the pooled F over the thresholds."""
    return float(np.mean([tally.f for tally in tallies(predictions, thresholds)]))


def _distances(prediction: Prediction) -> Float[np.ndarray, "k t"]:
    """D of every answer and truth."""
    answers, truths = map(prediction.to_diagonals.plane, (prediction.answers, prediction.truths))
    rows = [plane_distance(truths, Plane(*answer)) for answer in zip(*answers, strict=True)]
    return np.array(rows).reshape(len(rows), len(prediction.case.planes))
