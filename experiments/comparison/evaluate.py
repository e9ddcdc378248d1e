"""Runs one method on one corrupted cloud and scores it: the unit task of the comparison."""

import numpy as np

from experiments.baselines.registry import COMPILES_ONCE, COMPILES_PER_SIZE, ENTRIES
from experiments.comparison.attempt import attempt, ranked_planes
from experiments.comparison.objects import DENSE, BenchmarkObject, benchmark_object
from experiments.data import corruptions
from experiments.framework.tables import Row
from experiments.metrics import funk
from experiments.metrics.deviation import deviation
from experiments.metrics.gte import gte
from experiments.metrics.prediction import Prediction
from experiments.metrics.ranking import Ranking
from experiments.metrics.sde import NUM_SAMPLES, cloud_sde
from symjax import Detection

FUNCTION = f"{__name__}:evaluate"
"""The task function, as the runner addresses it."""

STEPS = int(funk.LARGEST_ANGLE)
"""Number of steps in the sweep of Funk's thresholds: one per degree of t_a."""

NO_ANSWER: Row = {
    "planes": [],
    "accepted": [],
    "found": False,
    "ambiguous": False,
    "angle": 90.0,
    "offset_error": 1.0,
    "gte": None,
    "gte_squared": None,
    "sde": None,
    "funk": [0] * (STEPS + 1),
    "funk_paper": [0] * (STEPS + 1),
}
"""Results of a method that raised an exception or exceeded a limit."""

WARM: set[tuple[str, str, int]] = set()
"""Methods, conditions and sizes for which this process has already compiled its programs."""


def evaluate(
    method: str, benchmark: str, item: int, name: str, condition: str, seed: int, num_points: int, data: str = ""
) -> Row:
    """Runs a method on an object, posed at random and then corrupted, and computes all metrics.

    An exception in the method counts as no answer.

    Args:
        method: a key of `ENTRIES`.
        benchmark: one of `objects.NAMES`.
        item: number of the object in the benchmark.
        name: name of the object.
        condition: a key of `corruptions.SWEEP_CONDITIONS`.
        seed: seed of the pose, the points, the corruption and the method.
        num_points: number of points before the corruption.
        data: folder of the benchmark.

    Returns:
        JSON values: the object; all ranked planes (normal, offset, score) and which of them the method accepts as
        mirror planes; for the best plane the angle (degrees) and offset error (diagonals) to the nearest true plane,
        GTE and SDE; the hits at Funk's thresholds, of all accepted planes and by the paper's protocol; the run time in
        seconds without compilation.

    Raises:
        ValueError: if the object with this number has another name, because the benchmark has changed.
    """
    whole = benchmark_object(benchmark, data, item, seed, num_points)
    if whole.case.name != name:
        raise ValueError(
            f"object {item} of {benchmark} is {whole.case.name!r}, not {name!r}: the benchmark has changed, "
            "so start a new file of results"
        )
    points = next(corruptions.trials([whole.case], [condition])).points
    key = (method, condition, num_points)
    entry = ENTRIES[method]
    if method in COMPILES_PER_SIZE or (method in COMPILES_ONCE and key not in WARM):
        WARM.add(key)
        attempt(entry, points, [seed, item])
    outcome = attempt(entry, points, [seed, item])
    row = _about(whole) | {"seconds": outcome.seconds, "raised": outcome.error}
    return row | (NO_ANSWER if outcome.detection is None else _scored(outcome.detection, whole))


def _about(whole: BenchmarkObject) -> Row:
    case = whole.case
    return {
        "group": case.group,
        "truths": [[*map(float, plane.normal), float(plane.offset)] for plane in case.planes],
        "centre": case.points.mean(axis=0).tolist(),
        "diagonal": float(case.diagonal),
    }


def _scored(detection: Detection, whole: BenchmarkObject) -> Row:
    (ranking, is_accepted), case = ranked_planes(detection), whole.case
    every = Prediction(ranking, case)
    accepted = Prediction(Ranking(*(column[is_accepted] for column in ranking)), case)
    best = ranking.plane()
    error, plane_error = deviation(best, case), gte(every)
    is_dense = len(whole.dense) >= DENSE
    sde = cloud_sde(best, case.points[:NUM_SAMPLES], whole.dense, case.diagonal) if is_dense else None
    return {
        "planes": np.column_stack(ranking).tolist(),
        "accepted": is_accepted.tolist(),
        "found": detection.found,
        "ambiguous": detection.ambiguous,
        "angle": float(error.angle),
        "offset_error": float(error.offset),
        "gte": plane_error.plain,
        "gte_squared": plane_error.squared,
        "sde": sde,
        "funk": [tally.hits for tally in funk.curve([funk.compared(accepted, whole.truths)], STEPS)],
        "funk_paper": [tally.hits for tally in funk.curve([funk.as_in_the_paper(every)], STEPS)],
    }
