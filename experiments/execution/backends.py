"""Runs tasks on this machine or on a cluster, in both cases in worker processes that can be killed."""

import warnings
from collections.abc import Generator, Sequence
from uuid import uuid4

from joblib import Parallel, delayed

from experiments.execution.limits import Limits
from experiments.execution.result import Result
from experiments.execution.task import Task
from experiments.execution.worker_pool import WorkerPool


def on_machine(tasks: Sequence[Task], limits: Limits, jobs: int) -> Generator[Result, None, None]:
    """Runs `jobs` tasks at a time (−1: one per core) and yields their results in order of completion."""
    # every thread only waits for a worker process of its own: joblib's own processes cannot be killed one by one, and
    # they outlive a killed runner
    parallel = Parallel(n_jobs=jobs, backend="threading", batch_size=1, return_as="generator_unordered")
    with WorkerPool() as pool, warnings.catch_warnings():
        # joblib warns about unused results when a run is interrupted
        warnings.filterwarnings("ignore", ".*limit unnecessary computation time")
        yield from parallel(delayed(pool.attempt)(task, limits) for task in tasks)


POOLS: dict[str, WorkerPool] = {}
"""The pool of every run in this process of a cluster; the workers of a killed run would still run its old code."""


def on_cluster(tasks: Sequence[Task], limits: Limits, address: str) -> Generator[Result, None, None]:
    """Runs tasks on a dask.distributed cluster and yields their results in order of completion.

    The workers of the cluster must be able to import `experiments`.

    Raises:
        OSError: if the scheduler cannot be reached.
        RuntimeError: if a function cannot be loaded, or if the cluster gave up tasks because all processes that ran
            them ended.
    """
    from distributed import CancelledError, Client, as_completed
    from distributed.scheduler import KilledWorker

    lost, run = 0, uuid4().hex
    with Client(address, set_as_default=False) as client:  # type: ignore[no-untyped-call]  # not annotated by dask
        client.run(_end_idle, on_error="ignore")
        try:
            # not joblib's backend for a cluster: it waits for ever for a task that the cluster gave up
            futures = client.map(_attempt, tasks, limits=limits, run=run, pure=False)
            for future in as_completed(futures, loop=client.loop):  # type: ignore[no-untyped-call]  # likewise
                try:
                    result = future.result()
                except (KilledWorker, CancelledError):
                    lost += 1
                    continue
                # the cluster recomputes results that it keeps if their process is lost
                future.release()
                yield result
        finally:
            client.run(_close, run, on_error="ignore")
    if lost:
        raise RuntimeError(f"{lost} tasks were lost with processes of the cluster: run again to repeat them")


def _pool(run: str) -> WorkerPool:
    return POOLS.setdefault(run, WorkerPool())


def _attempt(task: Task, limits: Limits, run: str) -> Result:
    return _pool(run).attempt(task, limits)


def _end_idle() -> None:
    for pool in list(POOLS.values()):
        pool.end_idle()


def _close(run: str) -> None:
    _pool(run).close()
