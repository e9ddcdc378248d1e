"""The F-score of E3Sym (Li et al., ICCV 2023), averaged over thresholds on the distance of planes as 4-vectors.

Predicted and true planes are matched one to one, nearest pairs first, and counts are pooled over the data set, as in
the public script `evaluate_official_benchmark.m` of prsnet-repro. Another public script (`metric_F1.py` of
EnhancedBackProjection) uses the four thresholds `COARSE`. It counts every pair that does not match as a false positive
and lets one predicted plane match several true ones; we use its thresholds, but not its counts.
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


def tallies(predictions: Sequence[Prediction], thresholds: Float[np.ndarray, " t"] = FINE) -> list[Tally]:
    """Pools the counts of all shapes at every threshold; the planes of a match are nearer than the threshold.

    Args:
        predictions: one per shape, also for shapes without a predicted or without a true plane.
        thresholds: upper limits on the distance of a match.
    """
    matched = [matching.by_cost(_distances(prediction)) for prediction in predictions]
    distances = np.sort(np.concatenate(matched)) if matched else np.empty(0)
    num_answers = sum(len(prediction.ranking.offsets) for prediction in predictions)
    num_truths = sum(len(prediction.case.planes) for prediction in predictions)
    hits = np.searchsorted(distances, thresholds, side="left")
    return [Tally(int(count), num_answers, num_truths) for count in hits]


def f_score(predictions: Sequence[Prediction], thresholds: Float[np.ndarray, " t"] = FINE) -> float:
    """Computes the mean over the thresholds of F, from pooled counts."""
    return float(np.mean([tally.f for tally in tallies(predictions, thresholds)]))


def _distances(prediction: Prediction) -> Float[np.ndarray, "k t"]:
    """Distances of all predicted planes from all true planes."""
    answers, truths = map(prediction.to_diagonals.plane, (prediction.answers, prediction.truths))
    rows = [plane_distance(truths, Plane(*answer)) for answer in zip(*answers, strict=True)]
    return np.array(rows).reshape(len(rows), len(prediction.case.planes))
