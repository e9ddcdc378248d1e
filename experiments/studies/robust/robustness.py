"""Which share of the answers is right, by method and condition: outliers, missing parts, noise, one-sided scans.

All methods see the same clouds, one after the other. An answer is right where the plane was found and its normal is
within 5 degrees and its offset within 2 % of the diagonal; in medians, what was not found counts as 90 degrees. `x
robust` is the median ratio of the times, the methods taking turns. The peer, the one other installable package for bare
points (`pip install ".[peers]"`), needs a quarter of a minute for 5 000 of them and is left out by default: `--methods
robust,pyclarcs --seeds 1`.
"""

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from tqdm import tqdm

from experiments.baselines.registry import ENTRIES, OURS, PYCLARCS, usable
from experiments.comparison import published
from experiments.comparison.attempt import attempt
from experiments.data import GENERATED_AND_REAL, corruptions
from experiments.data.cases import MODELS, generated_cases, kinds_of, real_cases
from experiments.data.corruptions import Trial
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import Deviation, deviation

METHODS = (OURS, "sym-hks-printed", "sym-hks", "sym-hks-cleaned", PYCLARCS)
"""By their names in `ENTRIES`."""

TARGETS = {
    "clean": 0.98,
    "out20": 0.97,
    "out60": 0.97,
    "out100": 0.97,
    "out300": 0.96,
    "miss15": 0.96,
    "miss28": 0.96,
    "miss40": 0.92,
    "both": 0.95,
    "noise1": 0.97,
    "view": 0.68,
}
"""Least shares of right answers, over models with one known plane."""

CLOSE = 1.0
"""Degrees within which the plane of a shape that is exact by construction should be."""

NO_ANSWER = Deviation(90.0, 1.0)
"""What counts where no plane was found."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_points: points of a cloud before it is corrupted.
        seeds: clouds of every model and kind.
        kinds: most generated kinds, and real models, with one plane that are run, counted from the first.
        data: folder of the real models.
        methods: which methods, separated by commas.
        conditions: which conditions, separated by commas.
    """

    num_points: int = 5000
    seeds: int = 3
    kinds: int = 1000
    data: str = str(MODELS)
    methods: str = ",".join(name for name in METHODS if name != PYCLARCS)
    conditions: str = corruptions.CONDITION_NAMES


SIZES = {"full": Config(), "small": Config(num_points=1500, seeds=1, kinds=2, conditions="clean,out100,both")}


def run(config: Config) -> list[Row]:
    """One row a cloud and method."""
    methods = usable(split_names(config.methods, METHODS))
    cases = list(generated_cases(config.num_points, config.seeds, kinds_of("single", config.kinds)))
    with_plane = (case for case in real_cases(Path(config.data), config.num_points, config.seeds) if case.planes)
    cases += islice(with_plane, config.kinds * config.seeds)
    names = split_names(config.conditions, corruptions.CONDITIONS)
    rows: list[Row] = []
    warm = ""
    for trial in tqdm(corruptions.trials(cases, names), total=len(cases) * len(names), disable=None):
        if trial.condition != warm:
            warm = trial.condition
            for method in methods:
                attempt(ENTRIES[method], trial.points)  # compiles what a cloud of this size needs
        rows += [_row(trial, method) for method in methods]
    return rows


def _row(trial: Trial, method: str) -> Row:
    detection, seconds, error = attempt(ENTRIES[method], trial.points)
    off = NO_ANSWER if detection is None else deviation(detection.plane, trial.case)
    found = detection is not None and detection.found
    return trial.about | {
        "method": method,
        "exact": trial.case.group in ("generated", "exact"),
        "found": found,
        "ambiguous": detection is not None and detection.ambiguous,
        "angle": off.angle,
        "offset_error": off.offset,
        "right": found and off.right,
        "seconds": seconds,
        "error": error,
    }


def summary(rows: list[Row]) -> list[Row]:
    """A line a condition, set of models and method."""
    lines = []
    printed = published.both()["the paper"]
    for condition, of_condition in grouped(rows, "condition").items():
        for made in (True, False):
            by_method = grouped((row for row in of_condition if (row["group"] == "generated") == made), "method")
            ours = _seconds(by_method.get(OURS, []))
            for method, group in by_method.items():
                times = _seconds(group)
                line: Row = {"condition": condition, "models": "generated" if made else "real", "method": method}
                line |= _rates(group)
                line |= {"median s": float(np.median(times)), "x robust": _median(times / ours) if len(ours) else "-"}
                lines.append(line | {"target": TARGETS[condition], "paper": printed.get(condition, "")})
    return lines


def _seconds(rows: list[Row]) -> np.ndarray:
    return np.array([row["seconds"] for row in rows])


def _rates(rows: list[Row]) -> Row:
    right, found, ambiguous, exact = (
        np.array([row[name] for row in rows]) for name in ("right", "found", "ambiguous", "exact")
    )
    angle = np.where(found, [row["angle"] for row in rows], NO_ANSWER.angle)
    sure = found & ~ambiguous
    return {
        "clouds": len(rows),
        "right": float(right.mean()),
        "found": float(found.mean()),
        "ambiguous": float(ambiguous.mean()),
        "right of sure": float(right[sure].mean()) if sure.any() else "-",
        "median deg": _median(angle),
        "exact: within 1 deg": float((angle[exact] < CLOSE).mean()) if exact.any() else "-",
        "exact: median deg": _median(angle[exact]),
        "raised": sum(bool(row["error"]) for row in rows),
    }


def _median(values: np.ndarray) -> float | str:
    return float(np.median(values)) if len(values) else "-"


STUDY = Study(
    "robustness",
    __doc__,
    SIZES,
    run,
    summary,
    data=GENERATED_AND_REAL,
    paper="its tables of outliers and missing parts",
)
