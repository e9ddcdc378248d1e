"""Effect of each stage of the robust method: the share of correct answers without the stage, by condition.

Each stage is removed by an option of `Robust`. Without a stage the scores change, but the threshold that they must
exceed was chosen for the whole method. The second half of the table therefore counts the correct planes, whether found
or not. On 46 clouds of the conditions `both` and `view`, the neutral boundary, the visibility and the outlier rule
improved the results; the agreement of normals and the exactness did not under these two conditions (one cloud of a
condition is 0.04).
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from tqdm import tqdm

from experiments.baselines.registry import Entry
from experiments.data import GENERATED_SINGLE, corruptions
from experiments.data.cases import generated_cases, kinds_of
from experiments.data.corruptions import Trial
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import deviation
from symjax.robust.method import Robust

SHARES = {"correct": "correct answers", "correct plane": "correct planes"}

OUTLIER_RULE = "outlier rule"
"""The only stage that is part of the preparation of the cloud: `detect(drop_outliers=False)` removes it."""

STAGES: dict[str, dict[str, Any]] = {
    "nothing": {},
    "agreement of normals": {"use_normals": False},
    "neutral boundary": {"boundary_penalty": 1.0},
    "visibility": {"use_visibility": False},
    "point confidence": {"use_point_confidence": False},
    "registration": {"register": False},
    "pair hypotheses": {"num_pair_hypotheses": 0},
    OUTLIER_RULE: {},
    "refinement": {"refine": False},
    "exact scoring": {"exact_scoring": False},
    "exactness": {"use_exactness": False},
}
"""The option of `Robust` that removes each stage."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_points: points of a cloud before the corruption.
        seeds: objects of each kind.
        kinds: number of kinds with a single mirror plane, from the first.
        conditions: names of the conditions, separated by commas.
        stages: stages that are removed one at a time, separated by commas; "nothing" is the whole method.
    """

    num_points: int = 5000
    seeds: int = 1
    kinds: int = 1000
    conditions: str = "clean,miss28,miss40,both,view"
    stages: str = ",".join(STAGES)


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=4, conditions="both,view")}


def run(config: Config) -> list[Row]:
    """Returns one row per stage and cloud."""
    cases = list(generated_cases(config.num_points, config.seeds, kinds_of("single", config.kinds)))
    trials = list(corruptions.trials(cases, split_names(config.conditions, corruptions.CONDITIONS)))
    return [_row(stage, trial) for stage in tqdm(split_names(config.stages, STAGES), disable=None) for trial in trials]


def without(stage: str) -> Entry:
    """Returns the robust method without a stage."""
    method = replace(Robust(), **STAGES[stage])
    return Entry(f"without {stage}", method, drop_outliers=False if stage == OUTLIER_RULE else None)


def _row(stage: str, trial: Trial) -> Row:
    detection = without(stage).detect(trial.points, np.random.default_rng(0))
    error = deviation(detection.plane, trial.case)
    row = trial.about | {"without": stage, "found": detection.found, "angle": error.angle, "offset_error": error.offset}
    return row | {"correct": detection.found and error.correct, "correct plane": error.correct}


def summary(rows: list[Row]) -> list[Row]:
    """Returns one line per stage with the shares of correct answers, then one with those of correct planes."""
    return [_line(stage, column, group) for column in SHARES for stage, group in grouped(rows, "without").items()]


def _line(stage: str, column: str, rows: list[Row]) -> Row:
    line: Row = {"without": stage, "share of": SHARES[column]}
    for condition, group in grouped(rows, "condition").items():
        line[condition] = float(np.mean([row[column] for row in group]))
    return line | {"all": float(np.mean([row[column] for row in rows])), "clouds": len(rows)}


STUDY = Study("ablation", __doc__, SIZES, run, summary, data=GENERATED_SINGLE)
