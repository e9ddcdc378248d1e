"""What came of a task."""

from typing import Any, Literal, NamedTuple

from experiments.execution.task import Parameters

Status = Literal["ok", "error", "timeout", "memory", "died"]
"""Returned a row; raised; over the time; over the memory; its process ended by itself."""


class Result(NamedTuple):
    """A line of the file of results.

    Attributes:
        identity: of the task.
        task: its parameters.
        status: how it ended.
        row: what the function returned; empty unless the status is "ok".
        failure: why there is no row.
        seconds: that it took, as a clock on the wall measures.
        host: the machine that it ran on.
        commit: of the code that was checked out, + where that was changed; empty where unknown, as in lines of old.
        limit: that ended it, seconds ("timeout") or MiB ("memory"); None where none did, and in lines of old.
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
        """Whether an earlier line of the task says the same, but for how long it took and where."""
        return earlier is not None and self == earlier._replace(task=self.task, seconds=self.seconds, host=self.host)

    @property
    def columns(self) -> dict[str, Any]:
        """The parameters, the row and how it ended, as one row of a table."""
        return {**self.task, **self.row, "status": self.status, "failure": self.failure}
