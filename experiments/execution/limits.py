"""Limits of time and memory for a task."""

from typing import NamedTuple

import psutil

from experiments.execution.result import Result, Status


class Limits(NamedTuple):
    """Limits of every task; None means no limit.

    Attributes:
        seconds: wall-clock time of a call; loading the function does not count.
        megabytes: resident memory of the worker process in MiB, modules included; its subprocesses do not count.
    """

    seconds: float | None = None
    megabytes: float | None = None

    def exceeded(self, seconds: float, pid: int) -> tuple[Status, str] | None:
        """Returns the status and the message of the limit that a process exceeds after `seconds`, or None."""
        if self.seconds is not None and seconds > self.seconds:
            return "timeout", f"more than {self.seconds:g} s"
        if self.megabytes is not None and _resident(pid) > self.megabytes:
            return "memory", f"more than {self.megabytes:g} MiB"
        return None

    def of(self, status: Status) -> float | None:
        """Returns the limit that leads to a status; None if there is none."""
        return {"timeout": self.seconds, "memory": self.megabytes}.get(status)

    def allow_more(self, result: Result) -> bool:
        """Returns whether a limit ended the task that is larger now, or that no longer applies."""
        limit = self.of(result.status)
        return result.limit is not None and (limit is None or limit > result.limit)


def _resident(pid: int) -> float:
    # not a limit of the kernel on the address space, which would count what JAX reserves and never touches
    try:
        return float(psutil.Process(pid).memory_info().rss) / 2**20
    except psutil.NoSuchProcess:
        return 0.0
