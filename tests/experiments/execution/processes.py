"""What the tests see of processes and files of results."""

import json
import time
from typing import NamedTuple

import psutil

from tests.experiments.execution import tasks
from tests.experiments.execution.tasks import DEADLINE


def here(function):
    return f"{tasks.__name__}:{function}"


def lines(path):
    """The lines of results, sorted, timings aside."""
    return sorted(json.dumps(json.loads(line) | {"seconds": 0}) for line in path.read_text().splitlines())


def until(happened):
    start = time.monotonic()
    while not happened():
        assert time.monotonic() - start < DEADLINE
        time.sleep(0.02)


class Mark(NamedTuple):
    """The processes that a task was begun in: that of the runner or of the cluster, and the task's own."""

    parent: int
    task: int


def marks(folder, k):
    """A mark for every time that a task was begun."""
    path = folder / f"mark{k}"
    return [Mark(*map(int, line.split())) for line in path.read_text().splitlines()] if path.exists() else []


def running(pid):
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def recorded(path):
    return path.read_bytes().count(b"\n") if path.exists() else 0
