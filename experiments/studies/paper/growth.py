"""Seconds of all methods on the same clouds as these grow, the exponent of each one's growth, and 1 042 points.

Methods take turns on generated objects, each in a process of its own with one thread of BLAS and JAX; SciPy's trees use
all cores where a method asks for it, as symjax does. The first call, which compiles, does not count. A call over the
limit of time or memory ends its method: larger clouds are not tried. Most thin a large cloud first: ours and those on
our matches to 10 000 points, Cicconet to 10 000, 3DSymm and PCA to 5 000, RANSAC on points to 2 000, Hruda to about
1 000, Nagar and Raman to 500, Kazhdan to 64^3 voxels. In the paper's table of times 3DSymm has all points: it has a row
of its own here. The paper's seconds are of the clouds of Funk et al. 2017, and of models of about 1 042 vertices, on
its machine.
"""

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
from tqdm import tqdm

from experiments.baselines.registry import COMPILES_PER_SIZE, ENTRIES, OURS, UNLIMITED, baseline_entry, usable
from experiments.baselines.three_d_symm import ThreeDSymm
from experiments.comparison.published import SECONDS
from experiments.data import GENERATED
from experiments.data.cases import generate_case
from experiments.execution.limits import Limits
from experiments.execution.task import Task
from experiments.execution.worker import Worker
from experiments.framework import figures
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from experiments.metrics.deviation import deviation

VERTICES = 1042
"""Of the paper's second table of times; no part of the growth."""

PRINTED = {
    "3DSymm": {5_000: 0.38, 10_000: 0.48, 50_000: 6.12, 100_000: 16.03, 300_000: 61.01},
    "the paper's": SECONDS | {VERTICES: 0.21},
    "Korman": {VERTICES: 0.97},
    "Mitra": {VERTICES: 0.42},
    "PRS-Net": {VERTICES: 0.0018},
}
"""The paper's seconds by number of points."""

TARGETS = {OURS: "<= 0.3"}
"""Of the exponent, from 5 000 to 300 000 points."""

OVER = ("timeout", "memory", "died")
"""After which a method is not tried again."""

COMPILING = 600.0
"""Seconds that a call may take which does not count."""

TIMED = "experiments.studies.paper.growth:timed"


METHODS = ENTRIES | {"3dsymm-all": baseline_entry("after 3DSymm, all points", ThreeDSymm(max_points=UNLIMITED))}


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        sizes: points of the clouds, separated by commas.
        repeats: calls at each size, on as many objects.
        kind: kind of object.
        methods: which methods, separated by commas.
        seconds: that a call may take.
        megabytes: of memory (MiB) that the process of a method may take.
    """

    sizes: str = "1042,5000,10000,20000,50000,100000,300000"
    repeats: int = 3
    kind: str = "quadruped"
    methods: str = ",".join(METHODS)
    seconds: float = 300.0
    megabytes: float = 12_000.0


QUICK = "robust,sym-hks,pca,mle,ransac-points,kazhdan,cicconet,hruda,nagar-raman,3dsymm,3dsymm-all"
SIZES = {"full": Config(), "small": Config(sizes="1042,2000,5000", repeats=1, methods=QUICK, seconds=10.0)}


def timed(method: str, kind: str, size: int, seed: int) -> Row:
    """Seconds of a call on a posed object, and degrees between its plane and the right one."""
    case = generate_case(kind, size, seed)
    start = perf_counter()
    found = METHODS[method].detect(case.points, np.random.default_rng(seed))
    seconds = perf_counter() - start
    return {"seconds": seconds, "angle": deviation(found.plane, case).angle}


def run(config: Config) -> list[Row]:
    """One row a call."""
    methods = usable(split_names(config.methods, METHODS))
    with ExitStack() as ends:
        workers = {name: Worker(TIMED) for name in methods}
        for worker in workers.values():
            ends.callback(worker.end)
        return list(_calls(config, workers))


def _calls(config: Config, workers: Mapping[str, Worker]) -> Iterator[Row]:
    sizes = sorted(int(size) for size in config.sizes.split(","))
    for size in tqdm(sizes, disable=None):
        for repeat in range(-1, config.repeats):
            for method, worker in workers.items():
                if repeat >= 0 or size == sizes[0] or method in COMPILES_PER_SIZE:
                    yield from _call(config, worker, method, size, repeat)


def _call(config: Config, worker: Worker, method: str, size: int, repeat: int) -> Iterator[Row]:
    """The row of a call that counts, or that was the method's last."""
    if not worker.alive:
        return
    parameters = {"method": method, "kind": config.kind, "size": size, "seed": max(repeat, 0)}
    limits = Limits(COMPILING if repeat < 0 else config.seconds, config.megabytes)
    result = worker.attempt(Task(TIMED, parameters), limits)
    if repeat >= 0 or result.status in OVER:
        said = {"seconds": "", "angle": ""} | result.row
        row: Row = {"method": method, "points": size, "repeat": repeat, "status": result.status}
        yield row | said | {"failure": result.failure}


def exponent(seconds: Mapping[int, float]) -> float | str:
    """The least-squares slope of log seconds over log points, without `VERTICES`; "-" for fewer than two sizes."""
    grown = {size: value for size, value in seconds.items() if size != VERTICES}
    if len(grown) < 2:
        return "-"
    return float(np.polyfit(np.log(list(grown)), np.log(list(grown.values())), 1)[0])


def medians(rows: list[Row]) -> dict[int, float]:
    """Median seconds of a method by size, where all its calls came to an end."""
    return {
        size: float(np.median([row["seconds"] for row in group]))
        for size, group in grouped(rows, "points").items()
        if all(row["status"] == "ok" for row in group)
    }


def summary(rows: list[Row]) -> list[Row]:
    """A line a method, and one for each that the paper prints."""
    sizes = sorted(dict.fromkeys(row["points"] for row in rows))
    lines = []
    for method, of_method in grouped(rows, "method").items():
        failed = {row["points"]: row["failure"] for row in of_method if row["status"] != "ok"}
        seconds = medians(of_method)
        angles = [row["angle"] for row in of_method if row["status"] == "ok"]
        line: Row = {"method": METHODS[method].title, "data": "generated, this machine"}
        line |= {f"{size} points, s": seconds.get(size, failed.get(size, "not tried")) for size in sizes}
        line |= {"exponent": exponent(seconds), "target": TARGETS.get(method, "")}
        lines.append(line | {"median deg": float(np.median(angles)) if angles else ""})
    for method, printed in PRINTED.items():
        if any(size in printed for size in sizes):
            line = {"method": f"{method}, printed", "data": "the paper's, its machine"}
            line |= {f"{size} points, s": printed.get(size, "") for size in sizes}
            lines.append(line | {"exponent": exponent(printed), "target": "", "median deg": ""})
    return lines


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Seconds over points, both logarithmic; what the paper prints is dashed, or dotted."""
    drawn = figures.new(10, 5.5)
    axes = drawn.subplots()
    for index, (method, group) in enumerate(grouped(rows, "method").items()):
        seconds = medians(group)
        label = f"{METHODS[method].title}: {exponent(seconds):.2}"
        line = axes.plot(list(seconds), list(seconds.values()), f"C{index % 10}{'o^'[index // 10 % 2]}-", label=label)
        line[0].set(markersize=4, linewidth=3.0 if method == OURS else 1.2)
    for method, printed in PRINTED.items():
        grown = {size: value for size, value in sorted(printed.items()) if size != VERTICES}
        if grown:
            style = {"3DSymm": "k:"}.get(method, "k--")
            axes.plot(list(grown), list(grown.values()), style, label=f"{method}, printed: {exponent(printed):.2}")
        if VERTICES in printed:
            axes.plot(VERTICES, printed[VERTICES], "kx")
            axes.annotate(f" {method}", (VERTICES, printed[VERTICES]), fontsize=7, va="center")
    axes.set(xscale="log", yscale="log", xlabel="points", ylabel="seconds")
    axes.set_title(f"{config.kind}, median of {config.repeats}; printed ones: other data, other machine", fontsize=10)
    drawn.legend(title="exponent of the growth", fontsize=7, loc="outside right upper")
    figures.save(drawn, path)


STUDY = Study("growth", __doc__, SIZES, run, summary, draw=draw, data=GENERATED, paper="its time table")
