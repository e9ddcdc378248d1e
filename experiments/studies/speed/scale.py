"""Seconds of a warm detection as clouds grow, and the peak memory of one with a million points.

Sizes take turns, so that what else the machine does falls on all of them alike.
"""

from dataclasses import dataclass
from time import perf_counter

import numpy as np
from tqdm import tqdm

import symjax
from experiments.data.descriptions import SINGLE
from experiments.framework.memory import peak_memory
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax import datasets

TARGET_RATIO = {300_000: "<= 2.5 x"}
TARGET_MEMORY = "<= 1024 MiB more"


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        sizes: points of the clouds that are timed; times are compared with the first.
        repeats: detections of each, on as many objects, after one that is not counted.
        memory_points: points of the cloud whose memory is measured; 0 leaves that out.
        kind: kind of object.
        method: method of `symjax.detect`.
    """

    sizes: tuple[int, ...] = (5_000, 50_000, 300_000)
    repeats: int = 5
    memory_points: int = 1_000_000
    kind: str = "quadruped"
    method: str = "robust"


SIZES = {"full": Config(), "small": Config(sizes=(1_500, 6_000), repeats=3, memory_points=50_000)}


def run(config: Config) -> list[Row]:
    """One row a detection that is timed, then one of memory."""
    rows: list[Row] = []
    # the first of every size compiles
    for repeat in tqdm(range(-1, config.repeats), disable=None):
        for size in config.sizes:
            points = datasets.generate(config.kind, num_points=size, rng=repeat + 1).points
            start = perf_counter()
            found = symjax.detect(points, config.method, rng=0)
            row = {"points": size, "used": found.num_used, "repeat": repeat, "seconds": perf_counter() - start}
            if repeat >= 0:
                rows.append(row | {"first MiB": "", "peak MiB": ""})
    if config.memory_points:
        points = datasets.generate(config.kind, num_points=config.memory_points, rng=0).points
        peak = peak_memory(points, config.method)
        row = {"points": config.memory_points, "used": "", "repeat": 0, "seconds": ""}
        rows.append(row | {"first MiB": peak.first, "peak MiB": peak.cloud})
    return rows


def summary(rows: list[Row]) -> list[Row]:
    """A line a size, and one of memory."""
    lines: list[Row] = []
    for size in dict.fromkeys(row["points"] for row in rows if row["seconds"] != ""):
        seconds = [row["seconds"] for row in rows if row["points"] == size and row["seconds"] != ""]
        median = float(np.median(seconds))
        line: Row = {"points": size, "times": len(seconds), "median s": median, "longest s": max(seconds)}
        line["ratio"] = median / lines[0]["median s"] if lines else 1.0
        nothing = dict.fromkeys(("MiB after first detection", "peak MiB", "more MiB"), "")
        lines.append(line | nothing | {"target": TARGET_RATIO.get(size, "")})
    for row in rows:
        if row["seconds"] == "":
            first, peak = row["first MiB"], row["peak MiB"]
            line = dict.fromkeys(lines[0], "") | {"points": row["points"], "target": TARGET_MEMORY}
            lines.append(line | {"MiB after first detection": first, "peak MiB": peak, "more MiB": peak - first})
    return lines


STUDY = Study("scale", __doc__, SIZES, run, summary, data=SINGLE, paper="its time table")
