"""What is run, and what came of it: all figures and tables share one file of results, so that nothing is done twice."""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

from experiments.baselines.registry import ENTRIES, usable
from experiments.comparison import evaluate, objects
from experiments.data.corruptions import SWEEP_CONDITIONS
from experiments.execution import run
from experiments.execution.result import Result
from experiments.framework.options import split_names
from experiments.framework.tables import Row

RESULTS = "arena.jsonl"
"""Name of the file of results, in the folder of the tables."""

METHODS = ",".join(ENTRIES)

OUTLIERS = "clean,out20,out40,out60,out80,out100,out120"
MISSING = "clean,miss15,miss20,miss28,miss40"
ALL = f"{OUTLIERS},{MISSING.removeprefix('clean,')},both,noise1,view"

UNKNOWN: Row = {"group": "", "truths": [[0.0, 0.0, 1.0, 0.0]], "centre": [0.0, 0.0, 0.0], "diagonal": 1.0}
"""Placeholder for an object that no method finished; counted as having one plane that was missed."""


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        benchmark: which benchmarks, separated by commas.
        objects: most objects of each.
        seeds: poses and corruptions of each object.
        num_points: points of a cloud before it is corrupted.
        methods: which methods, separated by commas.
        conditions: which conditions, separated by commas.
        data: folder of the benchmarks that are read; `real` has one of its own.
        results: file of results (JSON Lines), whose tasks are not done again; empty is `arena.jsonl` beside the tables.
        jobs: tasks at a time on this machine; −1 is one a core.
        dask: address of the scheduler of a cluster to run them on instead.
        seconds: that a task may take.
        megabytes: of memory (MiB) that its process may take.
    """

    benchmark: str = f"{objects.PROCEDURAL},real"
    objects: int = 300
    seeds: int = 1
    num_points: int = 5000
    methods: str = METHODS
    conditions: str = ALL
    data: str = ""
    results: str = ""
    jobs: int = -1
    dask: str = ""
    seconds: float = 600.0
    megabytes: float = 8000.0


SMALL = Config(benchmark=objects.PROCEDURAL, objects=40, num_points=700, conditions="clean,out100,miss28")

SLOWEST = "3dsymm-26"
"""A fifth of the time of all methods: left to the full size."""


def sizes(conditions: str, small: str, *, methods: str = METHODS) -> dict[str, Config]:
    """The two sizes of a study of some conditions, at the small size fewer."""
    fewer = ",".join(name for name in methods.split(",") if name != SLOWEST)
    return {
        "full": Config(conditions=conditions, methods=methods),
        "small": replace(SMALL, conditions=small, methods=fewer),
    }


def place(config: Config, folder: Path) -> Config:
    """The configuration with its file of results in the folder of the tables, unless it names another."""
    return config if config.results else replace(config, results=str(folder / RESULTS))


def tasks(config: Config) -> list[Row]:
    """The arguments of all calls of `evaluate`, an object after the other, so that it is made once a process.

    Raises:
        ValueError: a name is unknown.
        DataAbsentError: a benchmark is not in its folder.
    """
    methods = usable(split_names(config.methods, ENTRIES))
    conditions = split_names(config.conditions, SWEEP_CONDITIONS)
    return [
        {
            **{"method": method, "benchmark": benchmark, "item": item, "name": name, "condition": condition},
            **{"seed": seed, "num_points": config.num_points, "data": data},
        }
        for benchmark in split_names(config.benchmark, objects.NAMES)
        for data in ["" if benchmark in (objects.PROCEDURAL, objects.REAL) else str(Path(config.data).resolve())]
        for item, name in objects.items(benchmark, data, config.objects).items()
        for seed in range(config.seeds)
        for condition in conditions
        for method in methods
    ]


@lru_cache(maxsize=1)
def outcomes(config: Config) -> list[Row]:
    """A row a task: its arguments, what `evaluate` returned or, where a limit ended it, that there is no answer."""
    results = run(
        tasks(config),
        evaluate.FUNCTION,
        Path(config.results),
        jobs=config.jobs,
        dask=config.dask,
        seconds=config.seconds or None,
        megabytes=config.megabytes or None,
    )
    ended = Counter(result.status for result in results if result.status != "ok")
    if ended:
        first = next(result for result in results if result.status != "ok")
        print(f"TASKS WITHOUT A ROW: {dict(ended)}, the first {first.task}: {first.failure}", file=sys.stderr)
    return rows_of(results)


def rows_of(results: Sequence[Result]) -> list[Row]:
    """The rows of results; metadata missing from an aborted run is copied from another method's row.

    What ended with an error is no fault of a method, whose own are caught, and no row: data that is not on a machine of
    a cluster, or a bug of ours.
    """
    about = {_object(r): {name: r.row[name] for name in UNKNOWN} for r in results if r.status == "ok"}
    return [_row(result, about) for result in results if result.status != "error"]


def _row(result: Result, about: Mapping[tuple, Row]) -> Row:
    if result.status == "ok":
        return {**result.task, **result.row}
    ended = {"seconds": result.seconds, "raised": f"{result.status}: {result.failure}"}
    return {**result.task, **about.get(_object(result), UNKNOWN), **evaluate.NO_ANSWER, **ended}


def _object(result: Result) -> tuple:
    return tuple(result.task[name] for name in ("benchmark", "item", "name", "seed", "num_points", "data"))
