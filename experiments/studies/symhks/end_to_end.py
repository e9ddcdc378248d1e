"""End to end: `symjax.detect(points, method="sym-hks")` on random surface points in a random pose.

On the generated kinds, and on the real models of a folder where there is one. The mirror twins of a random sample are
not in it. A match is right where one point lies within 0.05 of the cloud's radius from the other's mirror image.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, islice
from pathlib import Path

import numpy as np
from tqdm import tqdm

import symjax
from experiments.data.cases import MODELS, Case, generated, real
from experiments.data.descriptions import WITH_REAL
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.detection.result import Detection
from symjax.errors import SymjaxWarning
from symjax.geometry import distance

WITHIN = 5.0
RIGHT_MATCH = 0.05

TARGETS = {"exact": ">= 0.85, median <= 2 deg"}


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_points: points of a cloud.
        seeds: clouds of every model and kind.
        data: folder of the real models.
        kinds: the generated kinds among them that are run, counted from the first.
    """

    num_points: int = 5000
    seeds: int = 3
    data: str = str(MODELS)
    kinds: int = 1000


SIZES = {"full": Config(), "small": Config(num_points=1500, seeds=1, kinds=3)}


def run(config: Config) -> list[Row]:
    """One row a cloud."""
    return [_row(case) for case in tqdm(_cases(config), disable=None)]


def _cases(config: Config) -> Iterator[Case]:
    made = islice(generated(config.num_points, config.seeds), config.kinds * config.seeds)
    return chain(made, real(Path(config.data), config.num_points, config.seeds))


def _row(case: Case) -> Row:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SymjaxWarning)
        found = symjax.detect(case.points, method="sym-hks", rng=0)
    row = {"model": case.name, "group": case.group, "found": found.found, "score": found.score}
    row |= {"threshold": found.threshold, "pairs": len(found.pairs.weight), "seconds": sum(found.timings.values())}
    if not case.planes:
        return row | {"angle": np.nan, "offset_error": np.nan, "right_matches": np.nan}
    nearest = min(case.planes, key=lambda plane: float(found.plane.angle(plane)))
    centre = case.points.mean(axis=0)
    return row | {
        "angle": float(found.plane.angle(nearest)),
        "offset_error": float(distance.offset_error(found.plane, nearest, centre, case.diagonal)),
        "right_matches": right_matches(found, case),
    }


def right_matches(found: Detection, case: Case) -> float:
    """Share of the pairs that some right plane mirrors onto each other."""
    radius = float(np.linalg.norm(case.points - case.points.mean(axis=0), axis=1).max())
    misses = [np.linalg.norm(plane.reflect(found.pairs.x) - found.pairs.y, axis=1) for plane in case.planes]
    return float(np.mean(np.min(misses, axis=0) < RIGHT_MATCH * radius))


def summary(rows: list[Row]) -> list[Row]:
    """A line a model, then one a group."""
    models = dict.fromkeys((row["group"], row["model"]) for row in rows)
    lines = [
        _line(model, group, [r for r in rows if (r["group"], r["model"]) == (group, model)]) for group, model in models
    ]
    groups = dict.fromkeys(row["group"] for row in rows)
    lines += [_line("ALL", group, [r for r in rows if r["group"] == group], TARGETS.get(group, "")) for group in groups]
    return lines


def _line(model: str, group: str, rows: list[Row], target: str = "") -> Row:
    angles = np.array([row["angle"] for row in rows])
    return {
        "model": model,
        "group": group,
        "clouds": len(rows),
        "within 5 deg": float(np.mean(angles < WITHIN)) if np.isfinite(angles).all() else "-",
        "median deg": float(np.median(angles)),
        "median offset": float(np.median([row["offset_error"] for row in rows])),
        "right matches": float(np.mean([row["right_matches"] for row in rows])),
        "found": float(np.mean([row["found"] for row in rows])),
        "median s": float(np.median([row["seconds"] for row in rows])),
        "target": target,
    }


STUDY = Study("end_to_end", __doc__, SIZES, run, summary, data=WITH_REAL)
