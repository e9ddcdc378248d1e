"""How often the 95 % region of a plane holds the true one: generated objects with noise, in random poses.

Clouds whose answer is wrong by more than 5 degrees, or ambiguous, are counted and left out of the rest: no standard
error speaks of another plane. Of unbiased normal errors the median is 0.83 standard errors of the normal and 0.67 of
the offset.
"""

from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

from experiments.baselines.registry import ENTRIES, OURS
from experiments.data import GENERATED_SINGLE
from experiments.data.cases import generate_case, kinds_of
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import WITHIN_ANGLE
from symjax import datasets
from symjax.geometry import distance

TARGET = "0.9 to 0.98"


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        clouds: number of clouds; kinds, levels and seeds take turns.
        kinds: most generated kinds with one plane, counted from the first.
        levels: standard deviations of the noise, in diagonals.
        least_points: fewest points of a cloud.
        most_points: most points of a cloud.
    """

    clouds: int = 400
    kinds: int = 1000
    levels: tuple[float, ...] = (0.002, 0.004, 0.006, 0.008, 0.01)
    least_points: int = 4000
    most_points: int = 5000


SIZES = {"full": Config(), "small": Config(clouds=8, levels=(0.002, 0.01), least_points=1500, most_points=1600)}


def run(config: Config) -> list[Row]:
    """One row a cloud."""
    kinds = kinds_of("single", config.kinds)
    rows = []
    for number in tqdm(range(config.clouds), disable=None):
        turn, which = divmod(number, len(config.levels))
        seed, kind = divmod(turn, len(kinds))
        rows.append(_row(kinds[kind], seed, config.levels[which], config))
    return rows


def _row(kind: str, seed: int, level: float, config: Config) -> Row:
    rng = np.random.default_rng([seed, round(1e6 * level), *kind.encode()])
    case = generate_case(kind, int(rng.integers(config.least_points, config.most_points + 1)), seed)
    points = datasets.corrupt(case.points, rng, noise=level, diagonal=case.diagonal).points
    found = ENTRIES[OURS].detect(points, np.random.default_rng(0))
    about = found.uncertainty
    if about is None:
        raise ValueError("the method says nothing of its uncertainty")
    (truth,) = case.planes
    return {
        "noise": level,
        "kind": kind,
        "seed": seed,
        "points": len(points),
        "found": found.found,
        "ambiguous": found.ambiguous,
        "angle": float(found.plane.angle(truth)),
        "angle error": about.normal_degrees,
        "offset": float(distance.offset_error(found.plane, truth, about.centre, case.diagonal)),
        "offset error": about.offset / case.diagonal,
        "distance": about.distance(found.plane, truth),
        "contained": about.contains(found.plane, truth),
    }


def summary(rows: list[Row]) -> list[Row]:
    """A line a level of noise, and one for all."""
    return [*(_line(level, group) for level, group in grouped(rows, "noise").items()), _line("all", rows)]


def _line(noise: float | str, rows: list[Row]) -> Row:
    right = [row for row in rows if row["angle"] <= WITHIN_ANGLE and not row["ambiguous"]]
    share = float(np.mean([row["contained"] for row in right])) if right else float("nan")

    def median(name: str) -> float:
        return float(np.median([row[name] for row in right])) if right else float("nan")

    return {
        "noise": noise,
        "clouds": len(rows),
        "wrong": sum(row["angle"] > WITHIN_ANGLE for row in rows),
        "ambiguous": sum(row["ambiguous"] for row in rows),
        "left": len(right),
        "found": sum(row["found"] for row in right),
        "contained": share,
        "+-": float(np.sqrt(share * (1 - share) / max(len(right), 1))),
        "standard error, deg": median("angle error"),
        "median error, deg": median("angle"),
        "standard error, offset": median("offset error"),
        "median error, offset": median("offset"),
        "target": TARGET,
    }


STUDY = Study("coverage", __doc__, SIZES, run, summary, data=f"{GENERATED_SINGLE}, with noise")
