"""How often the 95 % region of a plane contains the true plane, on generated objects with noise, in random poses.

Clouds whose plane is wrong by more than 5 degrees, or whose detection is ambiguous, are counted and excluded from the
other columns, because a standard error does not account for the choice of another plane. If the errors are unbiased and
normally distributed, their median is 0.83 standard errors for the normal and 0.67 for the offset.
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
    """Options of the study.

    Attributes:
        clouds: number of clouds, which cycle through the levels, kinds and seeds.
        kinds: number of kinds with a single mirror plane, from the first.
        levels: standard deviations of the noise, in diagonals.
        least_points: smallest number of points of a cloud.
        most_points: largest number of points of a cloud.
    """

    clouds: int = 400
    kinds: int = 1000
    levels: tuple[float, ...] = (0.002, 0.004, 0.006, 0.008, 0.01)
    least_points: int = 4000
    most_points: int = 5000


SIZES = {"full": Config(), "small": Config(clouds=8, levels=(0.002, 0.01), least_points=1500, most_points=1600)}


def run(config: Config) -> list[Row]:
    """Returns one row per cloud."""
    kinds = kinds_of("single", config.kinds)
    rows = []
    for number in tqdm(range(config.clouds), disable=None):
        cycle, level = divmod(number, len(config.levels))
        seed, kind = divmod(cycle, len(kinds))
        rows.append(_row(kinds[kind], seed, config.levels[level], config))
    return rows


def _row(kind: str, seed: int, level: float, config: Config) -> Row:
    rng = np.random.default_rng([seed, round(1e6 * level), *kind.encode()])
    case = generate_case(kind, int(rng.integers(config.least_points, config.most_points + 1)), seed)
    points = datasets.corrupt(case.points, rng, noise=level, diagonal=case.diagonal).points
    detection = ENTRIES[OURS].detect(points, np.random.default_rng(0))
    region = detection.uncertainty
    if region is None:
        raise ValueError(f"the detection of {kind!r} (seed {seed}) has no uncertainty, which this study measures")
    (truth,) = case.planes
    return {
        "noise": level,
        "kind": kind,
        "seed": seed,
        "points": len(points),
        "found": detection.found,
        "ambiguous": detection.ambiguous,
        "angle": float(detection.plane.angle(truth)),
        "angle error": region.normal_degrees,
        "offset": float(distance.offset_error(detection.plane, truth, region.centre, case.diagonal)),
        "offset error": region.offset / case.diagonal,
        "distance": region.distance(detection.plane, truth),
        "contained": region.contains(detection.plane, truth),
    }


def summary(rows: list[Row]) -> list[Row]:
    """Returns one line per level of noise, and one for all."""
    return [*(_line(level, group) for level, group in grouped(rows, "noise").items()), _line("all", rows)]


def _line(noise: float | str, rows: list[Row]) -> Row:
    evaluated = [row for row in rows if row["angle"] <= WITHIN_ANGLE and not row["ambiguous"]]
    share = float(np.mean([row["contained"] for row in evaluated])) if evaluated else float("nan")

    def median(name: str) -> float:
        return float(np.median([row[name] for row in evaluated])) if evaluated else float("nan")

    return {
        "noise": noise,
        "clouds": len(rows),
        "wrong": sum(row["angle"] > WITHIN_ANGLE for row in rows),
        "ambiguous": sum(row["ambiguous"] for row in rows),
        "evaluated": len(evaluated),
        "found": sum(row["found"] for row in evaluated),
        "contained": share,
        "+-": float(np.sqrt(share * (1 - share) / max(len(evaluated), 1))),
        "standard error, deg": median("angle error"),
        "median error, deg": median("angle"),
        "standard error, offset": median("offset error"),
        "median error, offset": median("offset"),
        "target": TARGET,
    }


STUDY = Study("coverage", __doc__, SIZES, run, summary, data=f"{GENERATED_SINGLE}, with noise")
