"""The experiments in the order in which they are presented."""

from pathlib import Path
from typing import NamedTuple

from experiments.framework.study import PROJECT


class Experiment(NamedTuple):
    """What is said of an experiment beside its docstring and its results.

    Attributes:
        data: what it runs on.
        paper: where the paper has the like of it.
    """

    data: str
    paper: str = "–"


SINGLE = "generated objects with one mirror plane, in random poses"
MADE = "generated objects of all kinds"
WITH_REAL = f"{MADE}, and the real models of `--data` where there are any"
BENCHMARKS = "generated objects, and at full size the real models; or any benchmark by `--benchmark` and `--data`"
PLANTED = "planted pairs: random blobs, their mirror images, and outliers"

CONTENTS = {
    "landscape": Experiment(PLANTED, "its second figure"),
    "deviation": Experiment(PLANTED, "its third figure"),
    "planted": Experiment(PLANTED, '"< 7° at 65 %"'),
    "start_angle": Experiment(SINGLE, "that L2 with alternation fails beyond 20° of the start"),
    "arena": Experiment(BENCHMARKS, "its comparisons"),
    "precision_recall": Experiment(BENCHMARKS, "its figure of precision against recall"),
    "outliers": Experiment(BENCHMARKS, "its table of outliers"),
    "missing": Experiment(BENCHMARKS, "its table of missing parts"),
    "robustness": Experiment(WITH_REAL, "its tables of outliers and missing parts"),
    "gte_sde": Experiment(BENCHMARKS, "its table of GTE and SDE"),
    "partial_scans": Experiment(BENCHMARKS, "its table of partial scans"),
    "completion": Experiment(MADE, "its figure of completion"),
    "articulated": Experiment("a generated figure with one leg swung forward", "last example of its partial models"),
    "growth": Experiment(MADE, "its time table"),
    "scale": Experiment(SINGLE, "its time table"),
    "timing": Experiment(SINGLE, "its time table"),
    "road": Experiment(WITH_REAL),
    "sym_hks_ablation": Experiment(SINGLE),
    "ablation": Experiment(SINGLE),
    "calibration": Experiment(WITH_REAL),
    "coverage": Experiment(f"{SINGLE}, with noise"),
    "equivariance": Experiment(MADE),
    "sphere": Experiment("points drawn on the unit sphere and on an ellipsoid"),
    "checks": Experiment(PLANTED),
    "transformations": Experiment(PLANTED),
    "gradient": Experiment(PLANTED),
    "success": Experiment(PLANTED),
    "self_scale": Experiment(PLANTED),
    "speed_objective": Experiment(PLANTED),
    "speed_fit": Experiment(PLANTED),
    "speed_sweep": Experiment(PLANTED),
}
"""By the name of the script."""


def script(name: str) -> Path:
    """The file of an experiment."""
    return PROJECT / "experiments" / f"{name}.py"
