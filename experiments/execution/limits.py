"""How long a task may take, and how much memory."""

from typing import NamedTuple

import psutil

from experiments.execution.result import Result, Status


class Limits(NamedTuple):
    """The limits of every task; None is no limit.

    Attributes:
        seconds: on the wall; loading the function does not count.
        megabytes: resident memory (MiB) of the task's process, with what is loaded; its own subprocesses do not count.
    """

    seconds: float | None = None
    megabytes: float | None = None

    def exceeded(self, seconds: float, pid: int) -> tuple[Status, str] | None:
        """Which limit a process that has worked for so many seconds is over, and the limit in words."""
        if self.seconds is not None and seconds > self.seconds:
            return "timeout", f"more than {self.seconds:g} s"
        if self.megabytes is not None and _resident(pid) > self.megabytes:
            return "memory", f"more than {self.megabytes:g} MiB"
        return None

    def of(self, status: Status) -> float | None:
        """The limit that ends a task with a status; None if there is none."""
        return {"timeout": self.seconds, "memory": self.megabytes}.get(status)

    def allow_more(self, result: Result) -> bool:
        """Whether a task that was ended by a limit now has a larger one, or none."""
        now = self.of(result.status)
        return result.limit is not None and (now is None or now > result.limit)


def _resident(pid: int) -> float:
    # an address-space limit of the kernel would count what JAX reserves and never touches
    try:
        return psutil.Process(pid).memory_info().rss / 2**20
    except psutil.NoSuchProcess:
        return 0.0
