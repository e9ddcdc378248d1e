"""One method on one corrupted cloud: the task that the arena is made of."""

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
"""What the runner is given."""

STEPS = int(funk.LARGEST_ANGLE)
"""Steps of the sweep of Funk's thresholds: a degree each."""

NO_ANSWER: Row = {
    "planes": [],
    "held": [],
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
"""The row of a method that raised, or was over a limit."""

WARM: set[tuple[str, str, int]] = set()
"""Methods, conditions and sizes that this process has compiled programs for."""


def evaluate(
    method: str, benchmark: str, item: int, name: str, condition: str, seed: int, num_points: int, data: str = ""
) -> Row:
    """What a method makes of an object in a random pose, corrupted then.

    Args:
        method: one of `ENTRIES`.
        benchmark: one of `objects.NAMES`.
        item: number of the object.
        name: of the object.
        condition: one of `corruptions.SWEEP_CONDITIONS`.
        seed: of the pose, the points, the corruption and the method.
        num_points: points before the corruption.
        data: folder of the benchmark.

    Returns:
        JSON values: the object; all ranked planes (normal, offset, score), which of them the method holds for mirror
        planes; of the best plane angle (degrees) and offset error (diagonals) to the nearest truth, GTE and SDE; hits
        at Funk's thresholds, of all planes that are held and in the paper's way; seconds, those of compilation left
        out. A method that raises has given no answer.

    Raises:
        ValueError: the object of this number has another name: the benchmark is not what it was.
    """
    whole = benchmark_object(benchmark, data, item, seed, num_points)
    if whole.case.name != name:
        raise ValueError(f"object {item} of {benchmark} is {whole.case.name!r} and not {name!r}")
    points = next(corruptions.trials([whole.case], [condition])).points
    key = (method, condition, num_points)
    entry = ENTRIES[method]
    if method in COMPILES_PER_SIZE or (method in COMPILES_ONCE and key not in WARM):
        WARM.add(key)
        attempt(entry, points, [seed, item])
    made = attempt(entry, points, [seed, item])
    row = _about(whole) | {"seconds": made.seconds, "raised": made.error}
    return row | (NO_ANSWER if made.detection is None else _scored(made.detection, whole))


def _about(whole: BenchmarkObject) -> Row:
    case = whole.case
    return {
        "group": case.group,
        "truths": [[*map(float, plane.normal), float(plane.offset)] for plane in case.planes],
        "centre": case.points.mean(axis=0).tolist(),
        "diagonal": float(case.diagonal),
    }


def _scored(detection: Detection, whole: BenchmarkObject) -> Row:
    (ranking, is_held), case = ranked_planes(detection), whole.case
    every = Prediction(ranking, case)
    held = Prediction(Ranking(*(column[is_held] for column in ranking)), case)
    off, error, best = deviation(ranking.plane(), case), gte(every), ranking.plane()
    seen = len(whole.dense) >= DENSE
    sde = cloud_sde(best, case.points[:NUM_SAMPLES], whole.dense, case.diagonal) if seen else None
    return {
        "planes": np.column_stack(ranking).tolist(),
        "held": is_held.tolist(),
        "found": detection.found,
        "ambiguous": detection.ambiguous,
        "angle": float(off.angle),
        "offset_error": float(off.offset),
        "gte": error.plain,
        "gte_squared": error.squared,
        "sde": sde,
        "funk": [tally.hits for tally in funk.curve([funk.compared(held, whole.truths)], STEPS)],
        "funk_paper": [tally.hits for tally in funk.curve([funk.as_in_the_paper(every)], STEPS)],
    }
