"""How often the robust method finds a symmetry in symmetric objects, and none in asymmetric ones, by condition.

The table also has the share of objects for which the kind of symmetry is correct: one plane, several planes, or an
axis. The lower lines have the rates that other `FoundThresholds` would give on the same clouds, computed from the
scores in the rows.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, islice, product
from pathlib import Path
from typing import get_args

import numpy as np
from jaxtyping import Bool, Float
from tqdm import tqdm

from experiments.baselines.registry import ENTRIES, OURS
from experiments.data import GENERATED_AND_REAL, corruptions
from experiments.data.cases import MODELS, Case, generated_cases, kinds_of, real_cases
from experiments.data.corruptions import Trial
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import deviation
from symjax.datasets.sample import Symmetry
from symjax.detection.result import Detection
from symjax.errors import SymjaxWarning
from symjax.geometry import distance
from symjax.preprocess.cloud import prepare
from symjax.robust.method import Robust
from symjax.robust.quadrics import fit_quadrics
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.thresholds import BACKGROUND, FoundThresholds, background, relative_noise

TRUTHS = {
    "generated": "one plane",
    "generated, multiple": "several planes",
    "generated, continuous": "axis",
    "generated, none": "none",
    "exact": "one plane",
    "near-exact": "one plane",
    "approximate": "one plane",
    "two planes": "several planes",
    "continuous symmetry about y, and y = 0": "axis",
    "no symmetry": "none",
    "a left boot": "none",
}
"""True symmetry of the cases of each group, except for the ball."""

BALL = "ball"
"""The kind that is a sphere: every line through its centre is an axis."""

SEVERAL = ("several planes", "axis", "sphere")

GRIDS: tuple[dict[str, tuple[float, ...]], ...] = (
    {"base": (-0.1, -0.05, 0.0, 0.05, 0.1), "per_background": (-0.2, -0.1, 0.0, 0.1, 0.2)},
    {"most": (-0.1, -0.05, 0.0, 0.05, 0.1)},
    {"exactness": (-0.1, -0.05, 0.0, 0.05, 0.1), "exact": (-0.1, 0.0, 0.1)},
    {"exactness_per_noise": (-0.2, -0.1, 0.0, 0.1, 0.2)},
)
"""Grids of thresholds: differences from the method's `FoundThresholds`; those of one grid vary together."""

RATES: tuple[tuple[str, tuple[str, ...], str], ...] = (
    ("not found: none", ("none",), "not found"),
    ("found: symmetric", ("one plane", "several planes", "axis"), "found"),
    ("ambiguous: one", ("one plane",), "ambiguous"),
    ("reported ambiguous or multiple: several", ("several planes",), "ambiguous or multiple"),
    ("reported ambiguous or multiple: axis", ("axis",), "ambiguous or multiple"),
    ("correct kind: one", ("one plane",), "correct kind"),
    ("correct kind: several", ("several planes",), "correct kind"),
    ("correct kind: axis", ("axis",), "correct kind"),
)
"""Columns of the table: title, true symmetries of the clouds that count, and column of the rows that is averaged."""

DISAGREEMENT = "clouds for which the rule of this study and the method disagree"

TARGETS = (">= 0.9", ">= 0.98", "<= 0.05", ">= 0.95", ">= 0.95", "reported", "reported", "reported", "reported")


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_points: points of a cloud before the corruption.
        seeds: clouds of each kind and model.
        kinds: number of generated kinds of each symmetry, and of real models, from the first.
        data: folder of the real models.
        conditions: names of the conditions, separated by commas.
    """

    num_points: int = 5000
    seeds: int = 3
    kinds: int = 1000
    data: str = str(MODELS)
    conditions: str = ",".join(name for name in corruptions.CONDITIONS if name not in ("view", "miss40"))


SIZES = {"full": Config(), "small": Config(num_points=1500, seeds=1, kinds=1, conditions="clean,both")}


def run(config: Config) -> list[Row]:
    """Returns one row per cloud."""
    cases = list(_cases(config))
    names = split_names(config.conditions, corruptions.CONDITIONS)
    trials = corruptions.trials(cases, names)
    return [_row(trial) for trial in tqdm(trials, total=len(cases) * len(names), disable=None)]


def _cases(config: Config) -> Iterator[Case]:
    kinds = chain.from_iterable(kinds_of(symmetry, config.kinds) for symmetry in get_args(Symmetry))
    models = islice(real_cases(Path(config.data), config.num_points, config.seeds), config.kinds * config.seeds)
    return chain(generated_cases(config.num_points, config.seeds, kinds), models)


def _row(trial: Trial) -> Row:
    # as many candidates as the background score is computed from
    entry = ENTRIES[OURS]._replace(max_planes=BACKGROUND.stop)
    detection = entry.detect(trial.points, np.random.default_rng(0))
    truth = TRUTHS[trial.case.group]
    symmetry = "sphere" if trial.case.name == BALL else truth
    return trial.about | {
        "truth": truth,
        "found": detection.found,
        "not found": not detection.found,
        "ambiguous": detection.ambiguous,
        "symmetry": detection.symmetry,
        "ambiguous or multiple": detection.ambiguous or detection.symmetry in SEVERAL,
        "correct kind": detection.symmetry == symmetry,
        "angle": deviation(detection.plane, trial.case).angle,
        "axis angle": _axis_angle(detection, trial.case),
        "score": detection.score,
        "threshold": detection.threshold,
        "exactness": detection.exactness,
        "background": background(detection.candidates),
        "noise": _noise(trial.points),
    }


def _noise(points: Float[np.ndarray, "n 3"]) -> float:
    """Relative noise of the surface, as the robust method estimates it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SymjaxWarning)
        cloud = prepare(points, drop_outliers=Robust.drops_outliers)
    surface = estimate_surface(cloud.points)
    return relative_noise(surface, fit_quadrics(surface))


def _axis_angle(detection: Detection, case: Case) -> float:
    """Angle between the detected and the true axis in degrees; NaN if either is missing or the object is a ball."""
    if detection.symmetry != "axis" or detection.axis is None or case.axis is None or case.name == BALL:
        return float("nan")
    return float(distance.deviation_angle(detection.axis[1], case.axis[1]))


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates the rates by condition, the targets, and the rates with other thresholds."""
    thresholds = Robust().found
    lines = [_line(condition, group) for condition, group in grouped(rows, "condition").items()]
    lines.append(_line("all, generated", [row for row in rows if row["group"].startswith("generated")]))
    lines.append(_line("all, real", [row for row in rows if not row["group"].startswith("generated")]))
    lines = [line for line in lines if line["clouds"]]
    lines.append(dict(zip(lines[0], ("TARGET", "", *TARGETS), strict=True)))
    for grid in GRIDS:
        for steps in product(*grid.values()):
            values = {name: getattr(thresholds, name) + step for name, step in zip(grid, steps, strict=True)}
            answers = [
                row | {"found": found, "not found": not found}
                for row, found in zip(rows, would_be_found(rows, replace(thresholds, **values)), strict=True)
            ]
            line = _line(", ".join(f"{name} {value:.2f}" for name, value in values.items()), answers)
            lines.append(line | dict.fromkeys(list(line)[4:], ""))
    differ = int(np.count_nonzero(would_be_found(rows, thresholds) != [row["found"] for row in rows]))
    lines.append(dict.fromkeys(lines[0], "") | {"clouds of": DISAGREEMENT, "clouds": differ})
    return lines


def _line(clouds_of: str, rows: list[Row]) -> Row:
    line: Row = {"clouds of": clouds_of, "clouds": len(rows)}
    for name, truths, column in RATES:
        values = [row[column] for row in rows if row["truth"] in truths]
        line[name] = float(np.mean(values)) if values else "-"
    angles = [row["axis angle"] for row in rows if np.isfinite(row["axis angle"])]
    return line | {"axis, median deg": float(np.median(angles)) if angles else "-"}


def would_be_found(rows: list[Row], thresholds: FoundThresholds) -> Bool[np.ndarray, " r"]:
    """Returns in which clouds the given thresholds find a plane, from the numbers in the rows."""
    names = ("score", "exactness", "background", "noise")
    score, exactness, other_scores, noise = (np.array([row[name] for row in rows], float) for name in names)
    return score > thresholds.threshold(exactness, other_scores, noise)


STUDY = Study("calibration", __doc__, SIZES, run, summary, data=GENERATED_AND_REAL)
