"""The result of a task."""

from typing import Any, Literal, NamedTuple

from experiments.execution.task import Parameters

Status = Literal["ok", "error", "timeout", "memory", "died"]
"""How a task ended: it returned a row, raised an error, exceeded the time or the memory limit, or its process died."""


class Result(NamedTuple):
    """One line of the file of results.

    Attributes:
        identity: identity of the task.
        task: parameters of the task.
        status: how the task ended.
        row: return value of the function; empty unless the status is "ok".
        failure: why there is no row; empty if the status is "ok".
        seconds: wall-clock time of the call.
        host: name of the machine.
        commit: commit of the code, with a + if the checkout had uncommitted changes; empty if unknown, as in old lines.
        limit: the limit that ended the task, in seconds ("timeout") or MiB ("memory"); None otherwise and in old lines.
    """

    identity: str
    task: Parameters
    status: Status
    row: dict[str, Any]
    failure: str
    seconds: float
    host: str
    commit: str = ""
    limit: float | None = None

    def repeats(self, earlier: "Result | None") -> bool:
        """Returns whether an earlier result of the task is the same, apart from the time it took and the machine."""
        return earlier is not None and self == earlier._replace(task=self.task, seconds=self.seconds, host=self.host)

    @property
    def columns(self) -> dict[str, Any]:
        """Parameters, row, status and failure as one row of a table."""
        return {**self.task, **self.row, "status": self.status, "failure": self.failure}
