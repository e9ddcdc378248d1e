"""Effect of each choice of Sym-HKS: the paper's method, with one choice at a time changed from symjax's default.

The paper leaves some choices open (times, pairs, σ), and symjax departs from the paper in others. While the radius r is
varied, the number of neighbours h does not bound the neighbourhood, and vice versa; by default both do. A pair is
correct if one point lies within 0.05 of the cloud's radius from the mirror image of the other. If the method fails, 90
degrees and no correct pairs count. Under the condition `out20 dropped`, outliers are removed before the matching; the
choice "outlier removal" sets this for all conditions.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from tqdm import tqdm

from experiments.baselines.registry import Entry
from experiments.data import GENERATED_SINGLE, corruptions
from experiments.data.cases import Case, generated_cases, kinds_of
from experiments.data.corruptions import Trial
from experiments.framework import figures
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import WITHIN_ANGLE, deviation
from experiments.studies.symhks.choices import CHOICES, DEFAULT, Variant
from symjax.detection.result import Detection
from symjax.errors import SymjaxError

DROPPED = " dropped"
"""Suffix of the names of conditions under which outliers are removed first."""

FAILURE_ANGLE = 90.0
"""Angle, in degrees, that counts if the method fails."""

MAX_DISTANCE = 0.05
"""Largest distance of a mirror image from the other point of a correct pair, in radii of the cloud."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_points: points of a cloud before the corruption.
        seeds: objects of each kind.
        kinds: number of kinds with a single mirror plane, from the first.
        conditions: names of the conditions, separated by commas; "out20 dropped" is "out20" with outliers removed.
        choices: names of the choices that are varied, separated by commas.
    """

    num_points: int = 5000
    seeds: int = 1
    kinds: int = 1000
    conditions: str = "clean,miss15,out20,out20 dropped"
    choices: str = ",".join(CHOICES)


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=1, conditions="clean,out20 dropped")}


def run(config: Config) -> list[Row]:
    """Returns one row per choice, value and cloud; the default, which all choices share, is measured once."""
    cases = list(generated_cases(config.num_points, config.seeds, kinds_of("single", config.kinds)))
    names = split_names(
        config.conditions, [*corruptions.CONDITIONS, *(name + DROPPED for name in corruptions.CONDITIONS)]
    )
    trials = [(name, trial) for name in names for trial in corruptions.trials(cases, [name.removesuffix(DROPPED)])]
    values = list(_values(split_names(config.choices, CHOICES)))
    variants = list(dict.fromkeys(variant for _, _, variant in values))
    measured = {variant: _measured(variant, trials) for variant in tqdm(variants, disable=None)}
    return [
        {"choice": choice, "value": value, "default": variant == DEFAULT, **row}
        for choice, value, variant in values
        for row in measured[variant]
    ]


def _values(choices: Sequence[str]) -> Iterator[tuple[str, str | float, Variant]]:
    for choice in choices:
        for value, variant in CHOICES[choice].items():
            yield choice, value, variant


def _measured(variant: Variant, trials: list[tuple[str, Trial]]) -> list[Row]:
    """One row per cloud, after a call that compiles the programs of the variant."""
    _detect(variant, *trials[0])
    return [_row(variant, name, trial) for name, trial in trials]


def _row(variant: Variant, name: str, trial: Trial) -> Row:
    start = perf_counter()
    detection = _detect(variant, name, trial)
    seconds = perf_counter() - start
    return {
        **trial.about,
        "condition": name,
        "angle": FAILURE_ANGLE if detection is None else deviation(detection.plane, trial.case).angle,
        "correct_pairs": 0.0 if detection is None else correct_pairs(detection, trial.case),
        "failed": detection is None,
        "seconds": seconds,
    }


def _detect(variant: Variant, name: str, trial: Trial) -> Detection | None:
    """The detection by a variant; None if the method raises a `SymjaxError`."""
    dropped = name.endswith(DROPPED) if variant.drop_outliers is None else variant.drop_outliers
    try:
        return Entry("", variant.method, dropped).detect(trial.points, np.random.default_rng(0))
    except SymjaxError:
        return None


def correct_pairs(detection: Detection, case: Case) -> float:
    """Computes the share of the pairs that are mirror pairs of a true plane."""
    radius = float(np.linalg.norm(case.points - case.points.mean(axis=0), axis=1).max())
    x, y = detection.pairs.x, detection.pairs.y
    distances = [np.linalg.norm(plane.reflect(x) - y, axis=1) for plane in case.planes]
    return float(np.mean(np.min(distances, axis=0) < MAX_DISTANCE * radius))


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates hit rate, median angle and share of correct pairs by condition, one line per value of a choice."""
    return [_line(group) for group in grouped(rows, "choice", "value").values()]


def _line(rows: list[Row]) -> Row:
    first = rows[0]
    line: Row = {"choice": first["choice"], "value": first["value"], "default": "*" if first["default"] else ""}
    for condition, group in grouped(rows, "condition").items():
        line[f"{condition}: within 5 deg"] = _hit_rate(group)
        line[f"{condition}: median deg"] = float(np.median([row["angle"] for row in group]))
        line[f"{condition}: correct pairs"] = float(np.mean([row["correct_pairs"] for row in group]))
    line |= {"within 5 deg": _hit_rate(rows), "failed": sum(row["failed"] for row in rows)}
    return line | {"median s": float(np.median([row["seconds"] for row in rows])), "clouds": len(rows)}


def _hit_rate(rows: list[Row]) -> float:
    return float(np.mean([row["angle"] < WITHIN_ANGLE for row in rows]))


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws the hit rate over every numeric choice, one line per condition; the default is dotted."""
    numeric = {
        choice: [value for value in CHOICES[choice] if not isinstance(value, str)]
        for choice in dict.fromkeys(row["choice"] for row in rows)
    }
    numeric = {choice: values for choice, values in numeric.items() if values}
    if not numeric:
        return
    columns = min(4, len(numeric))
    lines = -(-len(numeric) // columns)
    figure = figures.new(3.4 * columns, 2.8 * lines)
    axes = figure.subplots(lines, columns, sharey=True, squeeze=False)
    for ax in axes.flat[len(numeric) :]:
        ax.set_axis_off()
    for ax, (choice, values) in zip(axes.flat, numeric.items(), strict=False):
        for condition, group in grouped(grouped(rows, "choice")[choice], "condition").items():
            by_value = grouped(group, "value")
            ax.plot(values, [_hit_rate(by_value[v]) for v in values], marker="o", markersize=3, label=condition)
        for value in values:
            if CHOICES[choice][value] == DEFAULT:
                ax.axvline(value, color="gray", linestyle=":", linewidth=1)
        ax.set_xlabel(choice)
        ax.set_ylim(-0.03, 1.03)
        ax.grid(alpha=0.3)
    for ax in axes[:, 0]:
        ax.set_ylabel("within 5°")
    axes[0, 0].legend(fontsize=7, loc="lower right")
    figures.save(figure, path)


STUDY = Study("sym_hks_ablation", __doc__, SIZES, run, summary, draw=draw, data=GENERATED_SINGLE)
