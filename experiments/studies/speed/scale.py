"""Run time of a detection and of its stages as the number of points grows, and peak memory for a million points.

The sizes and methods take turns, so that other load on the machine affects them equally. The first detection of each
size and method, which compiles, is not counted. The study `growth` compares with the paper's times.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from tqdm import tqdm

import symjax
from experiments.data import GENERATED_SINGLE
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.studies.speed.memory import peak_memory
from symjax import datasets
from symjax.detection.methods import METHODS

TARGETS = {("robust", 300_000): "<= 2.5 x", ("sym-hks", 5_000): "< 1 s", ("sym-hks", 300_000): "< 8 s"}
TARGET_MEMORY = "<= 1024 MiB more"
MEMORY = ("MiB after first detection", "peak MiB", "more MiB")


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        sizes: numbers of points; the time of a method at each size is compared with that at its smallest size.
        repeats: detections of each size and method, each on another object.
        memory_points: points of the cloud for which memory is measured; 0 skips the measurement.
        kind: kind of object.
        methods: methods of `symjax.detect`, separated by commas; memory is measured for the first.
    """

    sizes: tuple[int, ...] = (5_000, 50_000, 300_000)
    repeats: int = 5
    memory_points: int = 1_000_000
    kind: str = "quadruped"
    methods: str = ",".join(METHODS)


SIZES = {"full": Config(), "small": Config(sizes=(1_500, 6_000), repeats=3, memory_points=50_000)}


def run(config: Config) -> list[Row]:
    """Returns one row per timed detection, then one of memory; columns that do not apply are empty."""
    methods = split_names(config.methods, METHODS)
    rows: list[Row] = []
    # the first detection of each size compiles
    for repeat in tqdm(range(-1, config.repeats), disable=None):
        for size in config.sizes:
            points = datasets.generate(config.kind, num_points=size, rng=repeat + 1).points
            for method in methods:
                start = perf_counter()
                detection = symjax.detect(points, method, rng=0)
                row = {"method": method, "points": size, "used": detection.num_used, "repeat": repeat}
                if repeat >= 0:
                    rows.append(row | {"seconds": perf_counter() - start} | _stages(detection.timings))
    if config.memory_points:
        points = datasets.generate(config.kind, num_points=config.memory_points, rng=0).points
        row = {"method": methods[0], "points": config.memory_points}
        rows.append(row | peak_memory(points, methods[0])._asdict())
    names = dict.fromkeys(name for row in rows for name in row)
    return [dict.fromkeys(names, "") | row for row in rows]


def _stages(timings: Mapping[str, float]) -> Row:
    return {f"{stage}, s": seconds for stage, seconds in timings.items()}


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates the median times of detections and stages by method and size, and the memory."""
    timed = [row for row in rows if row["seconds"] != ""]
    stages = [name for name in rows[0] if name.endswith(", s")]
    lines: list[Row] = []
    first: dict[str, float] = {}
    for (method, size), group in sorted(grouped(timed, "method", "points").items()):
        seconds = [row["seconds"] for row in group]
        median = float(np.median(seconds))
        line: Row = {"method": method, "points": size, "times": len(group), "median s": median}
        line |= {"longest s": max(seconds), "ratio": median / first.setdefault(method, median)}
        line |= {
            stage: "" if group[0][stage] == "" else float(np.median([r[stage] for r in group])) for stage in stages
        }
        lines.append(line | dict.fromkeys(MEMORY, "") | {"target": TARGETS.get((method, size), "")})
    for row in (row for row in rows if row["seconds"] == ""):
        peaks = row["first"], row["cloud"], row["cloud"] - row["first"]
        about = {"method": row["method"], "points": row["points"], "target": TARGET_MEMORY}
        lines.append(dict.fromkeys(lines[0], "") | about | dict(zip(MEMORY, peaks, strict=True)))
    return lines


STUDY = Study("scale", __doc__, SIZES, run, summary, data=GENERATED_SINGLE, paper="its time table")
