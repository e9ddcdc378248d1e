"""The tasks of the comparison and their results, in one file that all tables and figures share: no task runs twice."""

import sys
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from experiments.baselines.registry import ENTRIES, usable
from experiments.comparison import evaluate, objects
from experiments.data.corruptions import SWEEP_CONDITIONS
from experiments.execution import run
from experiments.execution.result import Result
from experiments.framework.options import split_names
from experiments.framework.tables import Row

RESULTS = "arena.jsonl"
"""Name of the file of results in the folder of the tables."""

FORMER_NAMES = {"held": "accepted"}
"""Present names of the columns that stored results of earlier versions name otherwise."""

METHODS = ",".join(ENTRIES)

OUTLIERS = "clean,out20,out40,out60,out80,out100,out120"
MISSING = "clean,miss15,miss20,miss28,miss40"
ALL = f"{OUTLIERS},{MISSING.removeprefix('clean,')},both,noise1,view"

UNKNOWN: Row = {"group": "", "truths": [[0.0, 0.0, 1.0, 0.0]], "centre": [0.0, 0.0, 0.0], "diagonal": 1.0}
"""Placeholder for an object on which no method finished: it counts as one missed plane."""


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        benchmark: names of the benchmarks, separated by commas.
        objects: largest number of objects of each benchmark.
        seeds: number of poses and corruptions of each object.
        num_points: points of a cloud before the corruption.
        methods: names of the methods, separated by commas.
        conditions: names of the conditions, separated by commas.
        data: folder of the benchmarks that are read from files; `real` has its own folder.
        results: file of results (JSON Lines); tasks in it are not run again. Empty is `arena.jsonl` beside the tables.
        jobs: number of parallel tasks on this machine; −1 is one per core.
        dask: address of a Dask scheduler, to run the tasks on a cluster instead.
        seconds: time limit of a task.
        megabytes: memory limit of a task's process, in MiB.
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
"""This method takes a fifth of the time of all methods, so the small size omits it."""


def sizes(conditions: str, small: str, *, methods: str = METHODS) -> dict[str, Config]:
    """Returns the full and the small configuration of a study.

    Args:
        conditions: conditions at full size, separated by commas.
        small: conditions at the small size, separated by commas.
        methods: methods, separated by commas.
    """
    fewer = ",".join(name for name in methods.split(",") if name != SLOWEST)
    return {
        "full": Config(conditions=conditions, methods=methods),
        "small": replace(SMALL, conditions=small, methods=fewer),
    }


def place(config: Config, folder: Path) -> Config:
    """Puts the file of results into the folder of the tables, unless the configuration names another file."""
    return config if config.results else replace(config, results=str(folder / RESULTS))


def tasks(config: Config) -> list[Row]:
    """Returns the arguments of all calls of `evaluate`, ordered by object, so that a process builds each object once.

    Raises:
        ValueError: if a name is unknown.
        DataAbsentError: if a benchmark is not in its folder.
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
    """Runs the tasks that the file of results does not have yet, and returns one row per task.

    A row has the arguments of the task and the result of `evaluate`, or `NO_ANSWER` if the task exceeded a limit.
    """
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
    """Converts results to rows; a task that was aborted takes the data of its object from another method's row.

    Tasks that ended with an error are omitted. `evaluate` catches the errors of methods, so the cause is elsewhere:
    data that is missing on a machine of the cluster, or a bug in the experiments.
    """
    about = {_object(r): {name: r.row[name] for name in UNKNOWN} for r in results if r.status == "ok"}
    return [_row(result, about) for result in results if result.status != "error"]


def _row(result: Result, about: Mapping[tuple[Any, ...], Row]) -> Row:
    if result.status == "ok":
        return {**result.task, **{FORMER_NAMES.get(name, name): value for name, value in result.row.items()}}
    ended = {"seconds": result.seconds, "raised": f"{result.status}: {result.failure}"}
    return {**result.task, **about.get(_object(result), UNKNOWN), **evaluate.NO_ANSWER, **ended}


def _object(result: Result) -> tuple[Any, ...]:
    """The arguments that determine the object of a task."""
    return tuple(result.task[name] for name in ("benchmark", "item", "name", "seed", "num_points", "data"))
