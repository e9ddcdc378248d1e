"""Share of correct answers by method and condition: outliers, missing parts, noise, scans from one side.

All methods run on the same clouds, in turn. An answer is correct if the plane was found, its normal is within 5 degrees
of the true one and its offset within 2 % of the diagonal. For the medians, a plane that was not found counts as 90
degrees. `x robust` is the median ratio of the run time to that of `robust`.

pyclarcs is the only other installable package for plain point clouds (`pip install ".[peers]"`). It takes a quarter of
a minute for 5 000 points and is not run by default; `--methods robust,pyclarcs --seeds 1` runs it.
"""

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from jaxtyping import Float
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
"""Names in `ENTRIES` of the methods of this study."""

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
"""Required shares of correct answers, over models with one known plane."""

CLOSE = 1.0
"""Largest angle, in degrees, to the plane of a shape that is symmetric by construction."""

NO_ANSWER = Deviation(90.0, 1.0)
"""Deviation that counts if a method gave no plane."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_points: points of a cloud before the corruption.
        seeds: clouds of each kind and model.
        kinds: number of generated kinds with a single mirror plane, and of real models with a plane, from the first.
        data: folder of the real models.
        methods: names of the methods, separated by commas.
        conditions: names of the conditions, separated by commas.
    """

    num_points: int = 5000
    seeds: int = 3
    kinds: int = 1000
    data: str = str(MODELS)
    methods: str = ",".join(name for name in METHODS if name != PYCLARCS)
    conditions: str = corruptions.CONDITION_NAMES


SIZES = {"full": Config(), "small": Config(num_points=1500, seeds=1, kinds=2, conditions="clean,out100,both")}


def run(config: Config) -> list[Row]:
    """Returns one row per cloud and method."""
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
                attempt(ENTRIES[method], trial.points)  # compiles the programs for clouds of this size
        rows += [_row(trial, method) for method in methods]
    return rows


def _row(trial: Trial, method: str) -> Row:
    detection, seconds, error = attempt(ENTRIES[method], trial.points)
    errors = NO_ANSWER if detection is None else deviation(detection.plane, trial.case)
    found = detection is not None and detection.found
    return trial.about | {
        "method": method,
        "exact": trial.case.group in ("generated", "exact"),
        "found": found,
        "ambiguous": detection is not None and detection.ambiguous,
        "angle": errors.angle,
        "offset_error": errors.offset,
        "correct": found and errors.correct,
        "seconds": seconds,
        "error": error,
    }


def summary(rows: list[Row]) -> list[Row]:
    """Returns one line per condition, set of models and method."""
    lines = []
    paper = published.outliers_and_missing()["the paper"]
    for condition, under_condition in grouped(rows, "condition").items():
        for models in ("generated", "real"):
            of_models = [row for row in under_condition if (row["group"] == "generated") == (models == "generated")]
            by_method = grouped(of_models, "method")
            robust = _seconds(by_method.get(OURS, []))
            for method, group in by_method.items():
                times = _seconds(group)
                line: Row = {"condition": condition, "models": models, "method": method} | _rates(group)
                line["median s"] = float(np.median(times))
                line["x robust"] = _median(times / robust) if len(robust) else "-"
                lines.append(line | {"target": TARGETS[condition], "paper": paper.get(condition, "")})
    return lines


def _seconds(rows: list[Row]) -> Float[np.ndarray, " r"]:
    return np.array([row["seconds"] for row in rows], float)


def _rates(rows: list[Row]) -> Row:
    correct, found, ambiguous, exact = (
        np.array([row[name] for row in rows]) for name in ("correct", "found", "ambiguous", "exact")
    )
    angle = np.where(found, [row["angle"] for row in rows], NO_ANSWER.angle)
    unambiguous = found & ~ambiguous
    return {
        "clouds": len(rows),
        "correct": float(correct.mean()),
        "found": float(found.mean()),
        "ambiguous": float(ambiguous.mean()),
        "correct if unambiguous": float(correct[unambiguous].mean()) if unambiguous.any() else "-",
        "median deg": _median(angle),
        "exact: within 1 deg": float((angle[exact] < CLOSE).mean()) if exact.any() else "-",
        "exact: median deg": _median(angle[exact]),
        "raised": sum(bool(row["error"]) for row in rows),
    }


def _median(values: Float[np.ndarray, " r"]) -> float | str:
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
