"""Runs many tasks with one file of results, and skips the tasks that have their result in it."""

import shlex
import sys
from collections import Counter
from collections.abc import Generator, Iterable
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from tqdm import tqdm

from experiments.execution.backends import on_cluster, on_machine
from experiments.execution.limits import Limits
from experiments.execution.result import Result
from experiments.execution.store import Store
from experiments.execution.task import Parameters, Task
from experiments.framework.provenance import provenance


@dataclass(frozen=True)
class Config:
    """How tasks are run, for the provenance; `run` documents the fields. Only the limits can change the results."""

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
    """Calls `function(**task)` for every task that has no result in a file, and appends each result at once.

    A task that raises, hangs, takes too much memory or ends its process gets that as its result, and the run goes on.
    If the file has several lines of a task, the last one counts. A task is repeated if it failed with an error, or if
    it exceeded a limit that is larger now (unless the line is so old that it does not name the limit). An error that
    occurs again is not written again. To repeat any other task, remove its line.

    Results of other commits are used, and a warning on stderr gives their number. Two states of a checkout with
    uncommitted changes cannot be distinguished. Every run appends its provenance (command, commit, versions, machine,
    time) and the number of earlier results to `NAME.runs.jsonl` beside the file.

    Args:
        tasks: keyword arguments of the calls, JSON values; equal ones are one task.
        function: `module:function`, importable here and by the cluster; it returns a row of JSON values and arrays.
        path: file of results, `NAME.jsonl`.
        jobs: number of tasks that run at a time on this machine; −1: one per core.
        dask: address (`tcp://…`) of a dask.distributed scheduler, to run the tasks on a cluster; empty: this machine.
        seconds: wall-clock limit of a task; None: no limit.
        megabytes: memory limit of a task's process in MiB; None: no limit.

    Returns:
        The results in the order of the tasks.

    Raises:
        OSError: if the file cannot be written or the scheduler cannot be reached.
        RuntimeError: if the function cannot be loaded, if another runner writes the file, or if a cluster lost tasks.
        ValueError: if a parameter of a task is not finite, or if a line of the file is not a result.
    """
    config, limits = Config(function, jobs, dask, seconds, megabytes), Limits(seconds, megabytes)
    wanted = [Task(function, parameters) for parameters in tasks]
    by_identity = {task.identity: task for task in wanted}
    with Store(path) as store:
        before = _results(store)
        done = {identity for identity, result in before.items() if _is_final(result, limits)}
        todo = [task for identity, task in by_identity.items() if identity not in done]
        about = _provenance(config, len(todo))
        _warn_of_other_code([before[identity] for identity in by_identity.keys() & done], about["commit"], store.path)
        if todo:
            with Store(path.with_suffix(".runs.jsonl")) as runs:
                runs.append({"results_before": len(store.items), **about})
            with closing(_attempt(config, limits, todo, len(by_identity))) as results:
                for result in results:
                    line = result._replace(commit=about["commit"])
                    if not line.repeats(before.get(line.identity)):
                        store.append(line._asdict())
        after = _results(store)
    return [after[task.identity] for task in wanted]


def _results(store: Store) -> dict[str, Result]:
    try:
        return {result.identity: result for result in (Result(**item) for item in store.items)}
    except TypeError as error:
        raise ValueError(f"{store.path} has a line that is not a result: {error}") from None


def _is_final(result: Result, limits: Limits) -> bool:
    # a study's function catches the errors of the method under test, so that an error here is one of the function or
    # the machine
    return result.status != "error" and not limits.allow_more(result)


def _provenance(config: Config, count: int) -> dict[str, Any]:
    """Returns the provenance of a run that is about to start, and so has no time yet."""
    about = provenance(shlex.join(sys.orig_argv), config, f"{count} tasks", datetime.now(UTC), 0.0)
    del about["wall_seconds"]
    return about


def _warn_of_other_code(used: list[Result], commit: str, path: Path) -> None:
    """Warns on stderr if results of other commits are used."""
    others = Counter(_short(result.commit) for result in used if result.commit != commit)
    if others:
        listed = ", ".join(f"{count} of {other}" for other, count in others.most_common())
        warning = f"{others.total()} OF {len(used)} RESULTS USED ARE OF OTHER CODE than {_short(commit)}: {listed}"
        print(f"{path}: {warning}; remove their lines to repeat these tasks", file=sys.stderr)


def _short(commit: str) -> str:
    return commit[:9] + "+" * commit.endswith("+") if commit else "an unknown commit"


def _attempt(config: Config, limits: Limits, todo: list[Task], total: int) -> Generator[Result, None, None]:
    """Yields the results in order of completion, and shows a progress bar."""
    results = on_cluster(todo, limits, config.dask) if config.dask else on_machine(todo, limits, config.jobs)
    failed: Counter[str] = Counter()
    with closing(results), tqdm(total=total, initial=total - len(todo), unit="task", disable=None) as bar:
        for result in results:
            yield result
            bar.update()
            if result.status != "ok":
                failed[result.status] += 1
                bar.set_postfix(failed)
