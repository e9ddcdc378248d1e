"""Helpers of the tests that look at processes and at files of results."""

import json
import time
from typing import NamedTuple

import psutil

from tests.experiments.execution import tasks
from tests.experiments.execution.tasks import DEADLINE


def here(function):
    """The name of a task function of the tests."""
    return f"{tasks.__name__}:{function}"


def lines(path):
    """The lines of a file of results, sorted, without their timings."""
    return sorted(json.dumps(json.loads(line) | {"seconds": 0}) for line in path.read_text().splitlines())


def until(happened):
    start = time.monotonic()
    while not happened():
        assert time.monotonic() - start < DEADLINE
        time.sleep(0.02)


class Mark(NamedTuple):
    """The processes that started a task and that ran it."""

    parent: int
    task: int


def marks(folder, k):
    """One mark for every start of a task."""
    path = folder / f"mark{k}"
    return [Mark(*map(int, line.split())) for line in path.read_text().splitlines()] if path.exists() else []


def running(pid):
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def recorded(path):
    return path.read_bytes().count(b"\n") if path.exists() else 0
