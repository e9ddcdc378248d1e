"""Seconds of every stage of both methods, warm: 5 000 points, and up to 300 000, which are thinned first.

The paper's times are of other objects on another machine; they stand beside ours for the order of magnitude.
"""

from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

import symjax
from experiments.comparison.published import SECONDS
from experiments.data.descriptions import SINGLE
from experiments.framework.options import chosen
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax import datasets
from symjax.detection.detect import METHODS

TARGETS = {5_000: "< 1 s", 300_000: "< 8 s"}
"""Of the paper's method; those of the other are in the study `scale`."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        sizes: points of the cloud.
        repeats: detections of each, on as many objects, after one that is not counted.
        kind: kind of object.
        methods: which methods, separated by commas; they take turns.
    """

    sizes: tuple[int, ...] = tuple(SECONDS)
    repeats: int = 5
    kind: str = "quadruped"
    methods: str = ",".join(METHODS)


SIZES = {"full": Config(), "small": Config(sizes=(2_000,), repeats=2)}


def run(config: Config) -> list[Row]:
    """One row a detection and stage."""
    rows = []
    for size in tqdm(config.sizes, disable=None):
        for repeat in range(-1, config.repeats):
            points = datasets.generate(config.kind, num_points=size, rng=repeat + 1).points
            for method in chosen(config.methods, METHODS):
                found = symjax.detect(points, method, rng=0)
                # the first compiles
                if repeat >= 0:
                    stages = found.timings | {"all": sum(found.timings.values())}
                    common = {"method": method, "points": size, "used": found.num_used, "repeat": repeat}
                    rows += [common | {"stage": stage, "seconds": seconds} for stage, seconds in stages.items()]
    return rows


def summary(rows: list[Row]) -> list[Row]:
    """Medians of every stage, a line a method and size."""
    stages = dict.fromkeys(row["stage"] for row in rows if row["stage"] != "all")
    lines = []
    for method, size in sorted(dict.fromkeys((row["method"], row["points"]) for row in rows)):
        of_size = [row for row in rows if (row["method"], row["points"]) == (method, size)]
        line: Row = {"method": method, "points": size, "used": of_size[0]["used"]}
        for stage in (*stages, "all"):
            seconds = [row["seconds"] for row in of_size if row["stage"] == stage]
            line[stage] = float(np.median(seconds)) if seconds else "-"
        papers = method == "sym-hks"
        line |= {"target": TARGETS.get(size, "") if papers else "", "paper": SECONDS.get(size, "") if papers else ""}
        lines.append(line)
    return lines


STUDY = Study("timing", __doc__, SIZES, run, summary, data=SINGLE, paper="its time table")
