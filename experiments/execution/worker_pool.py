"""The worker processes of the runner, or of one process of a cluster: as many as tasks run at a time."""

import threading
from types import TracebackType
from typing import Self

from experiments.execution.limits import Limits
from experiments.execution.result import Result
from experiments.execution.task import Task
from experiments.execution.worker import Worker


class WorkerPool:
    """Workers that are started on demand and reused for later tasks; threads may share a pool."""

    def __init__(self) -> None:
        """Creates an empty pool."""
        self._lock = threading.Lock()
        self._idle: list[Worker] = []
        self._busy: set[Worker] = set()
        self._closed = False

    def attempt(self, task: Task, limits: Limits) -> Result:
        """Runs a task.

        Raises:
            RuntimeError: if the function cannot be loaded or the pool is closed.
        """
        worker = self._idle_worker(task.function) or Worker(task.function)
        reused = worker.used
        result = self._attempt(worker, task, limits)
        # earlier tasks of the process may be the cause: try again in a new process
        if reused and result.status in ("memory", "died"):
            result = self._attempt(Worker(task.function), task, limits)
        return result

    def _idle_worker(self, function: str) -> Worker | None:
        with self._lock:
            for worker in self._idle:
                if worker.function == function:
                    self._idle.remove(worker)
                    return worker
        return None

    def _attempt(self, worker: Worker, task: Task, limits: Limits) -> Result:
        with self._lock:
            if self._closed:
                worker.end()
                raise RuntimeError("the runner has stopped")
            self._busy.add(worker)
        try:
            return worker.attempt(task, limits)
        finally:
            with self._lock:
                self._busy.remove(worker)
                if worker.alive:
                    self._idle.append(worker)

    def end_idle(self) -> None:
        """Ends the workers that have no task."""
        with self._lock:
            while self._idle:
                self._idle.pop().end()

    def close(self) -> None:
        """Ends all workers and refuses further tasks."""
        with self._lock:
            self._closed = True
            for worker in self._busy:
                worker.kill()
        self.end_idle()

    def __enter__(self) -> Self:
        """Returns the pool itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        """Closes the pool."""
        self.close()
