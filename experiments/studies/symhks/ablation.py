"""What every choice of Sym-HKS is worth: the paper's method as one choice at a time is changed from symjax's default.

The paper leaves some open (times, pairs, σ), and symjax departs from it in others. Radius r and neighbours h are each
varied alone: the other then does not bound the neighbourhood, while in the default both do. A match is right where one
point lies within 0.05 of the cloud's radius from the other's mirror image. Where the method gives up, 90 degrees count
and no match is right. Under `out20 dropped` outliers are dropped before the matching; the choice "front end" settles
that under every condition.
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
"""What is added to the name of a condition under which scattered outliers are left out first."""

GAVE_UP = 90.0
"""Degrees that count where there is no plane."""

RIGHT_MATCH = 0.05
"""Radii of the cloud within which a mirror image meets its partner."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_points: points of a cloud before it is corrupted.
        seeds: objects of every kind.
        kinds: most generated kinds with one plane, counted from the first.
        conditions: which conditions, separated by commas; "out20 dropped" is "out20", outliers left out first.
        choices: which choices are varied, separated by commas.
    """

    num_points: int = 5000
    seeds: int = 1
    kinds: int = 1000
    conditions: str = "clean,miss15,out20,out20 dropped"
    choices: str = ",".join(CHOICES)


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=1, conditions="clean,out20 dropped")}


def run(config: Config) -> list[Row]:
    """One row a cloud, choice and value; what several choices have in common, the default, is measured once."""
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
    """A row a cloud, after one that compiles what the variant needs."""
    _answer(variant, *trials[0])
    return [_row(variant, name, trial) for name, trial in trials]


def _row(variant: Variant, name: str, trial: Trial) -> Row:
    start = perf_counter()
    found = _answer(variant, name, trial)
    seconds = perf_counter() - start
    return {
        **trial.about,
        "condition": name,
        "angle": GAVE_UP if found is None else deviation(found.plane, trial.case).angle,
        "right_matches": 0.0 if found is None else right_matches(found, trial.case),
        "gave_up": found is None,
        "seconds": seconds,
    }


def _answer(variant: Variant, name: str, trial: Trial) -> Detection | None:
    """The method, or None where it raises one of its own errors."""
    dropped = name.endswith(DROPPED) if variant.drop_outliers is None else variant.drop_outliers
    try:
        return Entry("", variant.method, dropped).detect(trial.points, np.random.default_rng(0))
    except SymjaxError:
        return None


def right_matches(found: Detection, case: Case) -> float:
    """Share of the pairs that some right plane mirrors onto each other."""
    radius = float(np.linalg.norm(case.points - case.points.mean(axis=0), axis=1).max())
    misses = [np.linalg.norm(plane.reflect(found.pairs.x) - found.pairs.y, axis=1) for plane in case.planes]
    return float(np.mean(np.min(misses, axis=0) < RIGHT_MATCH * radius))


def summary(rows: list[Row]) -> list[Row]:
    """A line a value of a choice: hit rate, median angle and share of right matches by condition."""
    return [_line(group) for group in grouped(rows, "choice", "value").values()]


def _line(rows: list[Row]) -> Row:
    first = rows[0]
    line: Row = {"choice": first["choice"], "value": first["value"], "default": "*" if first["default"] else ""}
    for condition, of in grouped(rows, "condition").items():
        line[f"{condition}: within 5 deg"] = _hit_rate(of)
        line[f"{condition}: median deg"] = float(np.median([row["angle"] for row in of]))
        line[f"{condition}: right matches"] = float(np.mean([row["right_matches"] for row in of]))
    line |= {"within 5 deg": _hit_rate(rows), "gave up": sum(row["gave_up"] for row in rows)}
    return line | {"median s": float(np.median([row["seconds"] for row in rows])), "clouds": len(rows)}


def _hit_rate(rows: list[Row]) -> float:
    return float(np.mean([row["angle"] < WITHIN_ANGLE for row in rows]))


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Hit rate against every choice that is a number, a line a condition; the default is dotted."""
    numeric = {
        choice: [value for value in CHOICES[choice] if not isinstance(value, str)]
        for choice in dict.fromkeys(row["choice"] for row in rows)
    }
    numeric = {choice: values for choice, values in numeric.items() if values}
    if not numeric:
        return
    columns = min(4, len(numeric))
    lines = -(-len(numeric) // columns)
    drawn = figures.new(3.4 * columns, 2.8 * lines)
    axes = drawn.subplots(lines, columns, sharey=True, squeeze=False)
    for ax in axes.flat[len(numeric) :]:
        ax.set_axis_off()
    for ax, (choice, values) in zip(axes.flat, numeric.items(), strict=False):
        for condition, of in grouped(grouped(rows, "choice")[choice], "condition").items():
            by_value = grouped(of, "value")
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
    figures.save(drawn, path)


STUDY = Study("sym_hks_ablation", __doc__, SIZES, run, summary, draw=draw, data=GENERATED_SINGLE)
