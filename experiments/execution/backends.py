"""Where tasks run: on this machine, or on a cluster. Either way in workers that can be killed."""

import warnings
from collections.abc import Generator, Sequence
from uuid import uuid4

from joblib import Parallel, delayed

from experiments.execution.limits import Limits
from experiments.execution.result import Result
from experiments.execution.task import Task
from experiments.execution.worker_pool import WorkerPool


def on_machine(tasks: Sequence[Task], limits: Limits, jobs: int) -> Generator[Result, None, None]:
    """Results as they come, `jobs` tasks at a time (joblib's count: −1 is one a core)."""
    # threads that only wait, each for a process of its own: joblib's processes cannot be killed one by one, and outlive
    # a runner that is killed
    parallel = Parallel(n_jobs=jobs, backend="threading", batch_size=1, return_as="generator_unordered")
    with WorkerPool() as pool, warnings.catch_warnings():
        # a run that is interrupted need not hear that results were not used
        warnings.filterwarnings("ignore", ".*limit unnecessary computation time")
        yield from parallel(delayed(pool.attempt)(task, limits) for task in tasks)


POOLS: dict[str, WorkerPool] = {}
"""Of a process of the cluster, by the run: workers that a killed run left there still run the old code."""


def on_cluster(tasks: Sequence[Task], limits: Limits, address: str) -> Generator[Result, None, None]:
    """Results as they come from a dask.distributed scheduler, whose workers can import `experiments`.

    Raises:
        OSError: the scheduler is gone.
        RuntimeError: a function cannot be loaded, or tasks were given up, as all processes that did them ended.
    """
    from distributed import CancelledError, Client, as_completed
    from distributed.scheduler import KilledWorker

    lost, run = 0, uuid4().hex
    with Client(address, set_as_default=False) as client:
        client.run(_dismiss, on_error="ignore")
        try:
            # joblib's backend for a cluster waits for ever for a task that was given up
            futures = client.map(_attempt, tasks, limits=limits, run=run, pure=False)
            for future in as_completed(futures, loop=client.loop):
                try:
                    result = future.result()
                except (KilledWorker, CancelledError):
                    lost += 1
                    continue
                # a result that is kept there would be computed anew if its process were lost
                future.release()
                yield result
        finally:
            client.run(_close, run, on_error="ignore")
    if lost:
        raise RuntimeError(f"{lost} tasks were lost with the processes of the cluster: run again for them")


def _pool(run: str) -> WorkerPool:
    return POOLS.setdefault(run, WorkerPool())


def _attempt(task: Task, limits: Limits, run: str) -> Result:
    return _pool(run).attempt(task, limits)


def _dismiss() -> None:
    for pool in list(POOLS.values()):
        pool.dismiss()


def _close(run: str) -> None:
    _pool(run).close()
