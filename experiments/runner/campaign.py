"""Many tasks into one file: what it holds is not done again."""

import shlex
import sys
from collections import Counter
from collections.abc import Iterable
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from tqdm import tqdm

from experiments import report
from experiments.runner.limits import Limits
from experiments.runner.pool import on_cluster, on_machine
from experiments.runner.result import Result
from experiments.runner.store import Store
from experiments.runner.task import Parameters, Task


@dataclass(frozen=True)
class Config:
    """How tasks are run; what comes of them depends on the limits alone.

    Attributes:
        function: `module:function`.
        jobs: tasks at a time on this machine; −1 is one a core.
        dask: address of the scheduler of a cluster to run them on instead.
        seconds: that a task may take.
        megabytes: of memory (MiB) that its process may take.
    """

    function: str
    jobs: int = -1
    dask: str = ""
    seconds: float | None = None
    megabytes: float | None = None


def run(
    tasks: Iterable[Parameters],
    function: str,
    path: Path,
    *,
    jobs: int = -1,
    dask: str = "",
    seconds: float | None = None,
    megabytes: float | None = None,
) -> list[Result]:
    """Calls `function(**task)` for every task that a file has no result of, and appends what comes of it at once.

    A task that raises, hangs, takes too much memory or ends its process has that as its result, and the run goes on; to
    have it done again, remove its line. Where the rows come from (command, commit, versions, machine, time) is a line a
    run in `NAME.runs.jsonl` beside the file, with the number of results that were there before.

    Args:
        tasks: keyword arguments of the calls, JSON values; equal ones are one task.
        function: `module:function`, importable here and by the cluster; it returns a row: JSON values and arrays.
        path: the file of results, `NAME.jsonl`.
        jobs: tasks at a time on this machine; −1 is one a core.
        dask: address of the dask.distributed scheduler (`tcp://…`) of a cluster to run them on instead.
        seconds: that a task may take; None is no limit.
        megabytes: of memory (MiB) that its process may take; None is no limit.

    Returns:
        The results in the order of the tasks.

    Raises:
        OSError: the file cannot be written, or the scheduler is gone.
        RuntimeError: the function cannot be loaded, another runner writes the file, or tasks were lost with a cluster.
        ValueError: a task is not finite, or a line of the file is no result.
    """
    config = Config(function, jobs, dask, seconds, megabytes)
    wanted = [Task(function, parameters) for parameters in tasks]
    by_identity = {task.identity: task for task in wanted}
    with Store(path) as store:
        done = _results(store).keys()
        todo = [task for identity, task in by_identity.items() if identity not in done]
        if todo:
            _note(config, store, len(todo))
            _work(config, store, todo, len(by_identity))
        results = _results(store)
    return [results[task.identity] for task in wanted]


def _results(store: Store) -> dict[str, Result]:
    try:
        return {result.identity: result for result in (Result(**item) for item in store.items)}
    except TypeError as error:
        raise ValueError(f"{store.path} holds what is no result: {error}") from None


def _note(config: Config, store: Store, count: int) -> None:
    """Says where the results come from that are about to be written."""
    started, command = datetime.now(UTC), shlex.join(sys.orig_argv)
    about = report.provenance(command, config, f"{count} tasks", started, 0.0)
    del about["wall_seconds"]
    with Store(store.path.with_suffix(".runs.jsonl")) as runs:
        runs.append({"results_before": len(store.items), **about})


def _work(config: Config, store: Store, todo: list[Task], total: int) -> None:
    limits = Limits(config.seconds, config.megabytes)
    results = on_cluster(todo, limits, config.dask) if config.dask else on_machine(todo, limits, config.jobs)
    failed: Counter[str] = Counter()
    with closing(results), tqdm(total=total, initial=total - len(todo), unit="task", disable=None) as bar:
        for result in results:
            store.append(result._asdict())
            bar.update()
            if result.status != "ok":
                failed[result.status] += 1
                bar.set_postfix(failed)
