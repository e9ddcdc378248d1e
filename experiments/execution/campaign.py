"""Many tasks into one file: what has ended in it is not done again."""

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
    """Calls `function(**task)` for every task that has not ended in a file, and appends what comes of it at once.

    A task that raises, hangs, takes too much memory or ends its process has that as its result, and the run goes on. Of
    several lines of a task the last counts. Tasks are repeated if they failed with an error, or hit a limit smaller
    than the current one (but not if the line is old and does not say the limit). An error that comes again is not
    written again. To have any other task repeated, remove its line.

    Lines of another commit are used, and stderr is told how many; two states of a changed checkout are not told apart.
    Where the rows come from (command, commit, versions, machine, time) is a line a run in `NAME.runs.jsonl` beside the
    file, with the number of lines that were there before.

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
    config, limits = Config(function, jobs, dask, seconds, megabytes), Limits(seconds, megabytes)
    wanted = [Task(function, parameters) for parameters in tasks]
    by_identity = {task.identity: task for task in wanted}
    with Store(path) as store:
        before = _results(store)
        done = {identity for identity, result in before.items() if _is_end(result, limits)}
        todo = [task for identity, task in by_identity.items() if identity not in done]
        about = _about(config, len(todo))
        _tell([before[identity] for identity in by_identity.keys() & done], about["commit"], store.path)
        if todo:
            with Store(path.with_suffix(".runs.jsonl")) as runs:
                runs.append({"results_before": len(store.items), **about})
            with closing(_work(config, limits, todo, len(by_identity))) as results:
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
        raise ValueError(f"{store.path} holds what is no result: {error}") from None


def _is_end(result: Result, limits: Limits) -> bool:
    # functions return what their subjects raise: an error is of the function, or of the machine
    return result.status != "error" and not limits.allow_more(result)


def _about(config: Config, count: int) -> dict[str, Any]:
    """Where the results come from that are about to be written."""
    about = provenance(shlex.join(sys.orig_argv), config, f"{count} tasks", datetime.now(UTC), 0.0)
    del about["wall_seconds"]
    return about


def _tell(used: list[Result], commit: str, path: Path) -> None:
    """Says loudly what is used of other code."""
    others = Counter(_short(result.commit) for result in used if result.commit != commit)
    if others:
        listed = ", ".join(f"{count} of {other}" for other, count in others.most_common())
        said = f"{others.total()} OF {len(used)} RESULTS USED ARE OF OTHER CODE than {_short(commit)}: {listed}"
        print(f"{path}: {said}; remove their lines to have them done again", file=sys.stderr)


def _short(commit: str) -> str:
    return commit[:9] + "+" * commit.endswith("+") if commit else "an unknown commit"


def _work(config: Config, limits: Limits, todo: list[Task], total: int) -> Generator[Result, None, None]:
    """Results as they come, with a bar of progress."""
    results = on_cluster(todo, limits, config.dask) if config.dask else on_machine(todo, limits, config.jobs)
    failed: Counter[str] = Counter()
    with closing(results), tqdm(total=total, initial=total - len(todo), unit="task", disable=None) as bar:
        for result in results:
            yield result
            bar.update()
            if result.status != "ok":
                failed[result.status] += 1
                bar.set_postfix(failed)
