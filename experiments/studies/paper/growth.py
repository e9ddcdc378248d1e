"""Run time of all methods on the same clouds as the number of points grows, and the exponent of this growth.

The methods take turns on generated objects. Each runs in a process of its own, with one thread for BLAS and JAX;
SciPy's k-d trees use all cores if a method requests it, as symjax does. The first call, which compiles, does not count.
After a call that exceeds the limit of time or memory, its method is not run again.

Most methods thin a large cloud first: symjax, Algorithm 1 and the methods on its matches to 10 000 points, Cicconet to
10 000, 3DSymm and PCA to 5 000, RANSAC on points to 2 000, Hruda to about 1 000, Nagar and Raman to 500. Kazhdan uses a
grid of 64³ voxels. In the paper's table of times, 3DSymm uses all points, so that variant has a row of its own here.
The paper's times are for the clouds of Funk et al. 2017 and, in a second table, for models of about 1 042 vertices, on
the authors' machine.
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
"""Size of the models in the paper's second table of times; it is not used in the exponents."""

PUBLISHED = {
    "3DSymm": {5_000: 0.38, 10_000: 0.48, 50_000: 6.12, 100_000: 16.03, 300_000: 61.01},
    "the paper's": SECONDS | {VERTICES: 0.21},
    "Korman": {VERTICES: 0.97},
    "Mitra": {VERTICES: 0.42},
    "PRS-Net": {VERTICES: 0.0018},
}
"""Run times in the paper, in seconds by number of points."""

TARGETS = {OURS: "<= 0.3"}
"""Targets for the exponent between 5 000 and 300 000 points."""

FATAL = ("timeout", "memory", "died")
"""Statuses after which a method is not run again."""

COMPILE_SECONDS = 600.0
"""Time limit of a call that does not count, because it may compile."""

TIMED = "experiments.studies.paper.growth:timed"

METHODS = ENTRIES | {"3dsymm-all": baseline_entry("after 3DSymm, all points", ThreeDSymm(max_points=UNLIMITED))}


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        sizes: numbers of points of the clouds, separated by commas.
        repeats: calls at each size, each on another object.
        kind: kind of object.
        methods: names of the methods, separated by commas.
        seconds: time limit of a call.
        megabytes: memory limit of a method's process, in MiB.
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
    """Times a call on a posed object, and computes the angle of its plane to the true one in degrees."""
    case = generate_case(kind, size, seed)
    start = perf_counter()
    found = METHODS[method].detect(case.points, np.random.default_rng(seed))
    seconds = perf_counter() - start
    return {"seconds": seconds, "angle": deviation(found.plane, case).angle}


def run(config: Config) -> list[Row]:
    """Returns one row per call."""
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
    """Yields the row of a call if the call counts, or is the last of its method."""
    if not worker.alive:
        return
    parameters = {"method": method, "kind": config.kind, "size": size, "seed": max(repeat, 0)}
    limits = Limits(COMPILE_SECONDS if repeat < 0 else config.seconds, config.megabytes)
    result = worker.attempt(Task(TIMED, parameters), limits)
    if repeat >= 0 or result.status in FATAL:
        row: Row = {"method": method, "points": size, "repeat": repeat, "status": result.status}
        yield row | {"seconds": "", "angle": ""} | result.row | {"failure": result.failure}


def exponent(seconds: Mapping[int, float]) -> float | str:
    """Fits log seconds over log points by least squares, without `VERTICES`, and returns the slope.

    Returns "-" for fewer than two sizes.
    """
    fitted = {size: value for size, value in seconds.items() if size != VERTICES}
    if len(fitted) < 2:
        return "-"
    return float(np.polyfit(np.log(list(fitted)), np.log(list(fitted.values())), 1)[0])


def medians(rows: list[Row]) -> dict[int, float]:
    """Computes the median seconds of a method by size, for the sizes at which all its calls succeeded."""
    return {
        size: float(np.median([row["seconds"] for row in group]))
        for size, group in grouped(rows, "points").items()
        if all(row["status"] == "ok" for row in group)
    }


def summary(rows: list[Row]) -> list[Row]:
    """Returns one line per method, and one per method in the paper."""
    sizes = sorted(dict.fromkeys(row["points"] for row in rows))
    lines = []
    for method, group in grouped(rows, "method").items():
        failed = {row["points"]: row["failure"] for row in group if row["status"] != "ok"}
        seconds = medians(group)
        angles = [row["angle"] for row in group if row["status"] == "ok"]
        line: Row = {"method": METHODS[method].title, "data": "generated, this machine"}
        line |= {f"{size} points, s": seconds.get(size, failed.get(size, "not tried")) for size in sizes}
        line |= {"exponent": exponent(seconds), "target": TARGETS.get(method, "")}
        lines.append(line | {"median deg": float(np.median(angles)) if angles else ""})
    for method, seconds in PUBLISHED.items():
        if any(size in seconds for size in sizes):
            line = {"method": f"{method}, published", "data": "the paper's data and machine"}
            line |= {f"{size} points, s": seconds.get(size, "") for size in sizes}
            lines.append(line | {"exponent": exponent(seconds), "target": "", "median deg": ""})
    return lines


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws seconds over points, both logarithmic; the paper's times are dashed, for 3DSymm dotted."""
    figure = figures.new(10, 5.5)
    axes = figure.subplots()
    for index, (method, group) in enumerate(grouped(rows, "method").items()):
        seconds = medians(group)
        label = f"{METHODS[method].title}: {exponent(seconds):.2}"
        line = axes.plot(list(seconds), list(seconds.values()), f"C{index % 10}{'o^'[index // 10 % 2]}-", label=label)
        line[0].set(markersize=4, linewidth=3.0 if method == OURS else 1.2)
    for method, seconds in PUBLISHED.items():
        fitted = {size: value for size, value in sorted(seconds.items()) if size != VERTICES}
        if fitted:
            style = {"3DSymm": "k:"}.get(method, "k--")
            axes.plot(list(fitted), list(fitted.values()), style, label=f"{method}, published: {exponent(seconds):.2}")
        if VERTICES in seconds:
            axes.plot(VERTICES, seconds[VERTICES], "kx")
            axes.annotate(f" {method}", (VERTICES, seconds[VERTICES]), fontsize=7, va="center")
    axes.set(xscale="log", yscale="log", xlabel="points", ylabel="seconds")
    axes.set_title(f"{config.kind}, median of {config.repeats}; published: other data and machine", fontsize=10)
    figure.legend(title="exponent of the growth", fontsize=7, loc="outside right upper")
    figures.save(figure, path)


STUDY = Study("growth", __doc__, SIZES, run, summary, draw=draw, data=GENERATED, paper="its time table")
