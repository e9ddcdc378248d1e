"""What every stage of the robust method is good for: the share of right answers without it, by condition.

Every stage has an option of `Robust` that removes it. Without a stage scores change, and the threshold that they must
exceed was chosen for the whole method; so a second table has the planes that are right, whether found or not.
On 46 clouds of `both` and `view` the neutral boundary, the visibility and the outlier rule earned their place;
agreement of normals and exactness did not on these two (one cloud of a condition is 0.04).
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

SHARES = {"right": "right answers", "right plane": "right planes"}

OUTLIER_RULE = "outlier rule"
"""The one stage that belongs to the preparation of the cloud: `detect(drop_outliers=False)` removes it."""

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
"""The options of `Robust` that remove every stage."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_points: points of a cloud before it is corrupted.
        seeds: objects of every kind.
        kinds: most generated kinds with one plane, counted from the first.
        conditions: which conditions, separated by commas.
        stages: which stages are removed, one at a time, separated by commas; "nothing" is the whole method.
    """

    num_points: int = 5000
    seeds: int = 1
    kinds: int = 1000
    conditions: str = "clean,miss28,miss40,both,view"
    stages: str = ",".join(STAGES)


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=4, conditions="both,view")}


def run(config: Config) -> list[Row]:
    """One row a cloud and stage."""
    cases = list(generated_cases(config.num_points, config.seeds, kinds_of("single", config.kinds)))
    trials = list(corruptions.trials(cases, split_names(config.conditions, corruptions.CONDITIONS)))
    return [_row(stage, trial) for stage in tqdm(split_names(config.stages, STAGES), disable=None) for trial in trials]


def without(stage: str) -> Entry:
    """The robust method without a stage."""
    method = replace(Robust(), **STAGES[stage])
    return Entry(f"without {stage}", method, drop_outliers=False if stage == OUTLIER_RULE else None)


def _row(stage: str, trial: Trial) -> Row:
    found = without(stage).detect(trial.points, np.random.default_rng(0))
    off = deviation(found.plane, trial.case)
    row = trial.about | {"without": stage, "found": found.found, "angle": off.angle, "offset_error": off.offset}
    return row | {"right": found.found and off.right, "right plane": off.right}


def summary(rows: list[Row]) -> list[Row]:
    """A line a stage: the shares of right answers, then of right planes, found or not."""
    return [_line(stage, of, group) for of in SHARES for stage, group in grouped(rows, "without").items()]


def _line(stage: str, of: str, rows: list[Row]) -> Row:
    line: Row = {"without": stage, "share of": SHARES[of]}
    for condition, group in grouped(rows, "condition").items():
        line[condition] = float(np.mean([row[of] for row in group]))
    return line | {"all": float(np.mean([row[of] for row in rows])), "clouds": len(rows)}


STUDY = Study("ablation", __doc__, SIZES, run, summary, data=GENERATED_SINGLE)
