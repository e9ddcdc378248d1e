"""The program of a worker process: loads a function and calls it for every task that arrives through a pipe.

`experiments.execution.worker` starts it by `python -m experiments.execution.serving PIPE PARENT module:function`.
"""

import ctypes
import importlib
import json
import os
import random
import signal
import sys
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from experiments.execution.task import Task

PR_SET_PDEATHSIG = 1
"""Constant of Linux's `sys/prctl.h`."""


def _die_with(parent: int) -> None:
    """Makes the kernel kill this process when its parent ends, even within C code. Only Linux can do this.

    On other systems the process ends after its current task, when it finds the pipe closed.
    """
    if sys.platform != "linux":
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit()
    # if the machine runs out of memory, the kernel should kill a task rather than the runner
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")


def _load(name: str) -> Callable[..., dict[str, Any]]:
    module, _, attribute = name.partition(":")
    function: Callable[..., dict[str, Any]] = getattr(importlib.import_module(module), attribute)
    return function


def _reply(function: Callable[..., dict[str, Any]], task: Task) -> str:
    """Calls the function and returns status, row, failure and seconds as JSON."""
    # for functions that use the global generators: their numbers must not depend on the earlier tasks
    random.seed(task.seed)
    np.random.seed(task.seed)  # noqa: NPY002
    start = perf_counter()
    try:
        row = function(**task.parameters)
        seconds = perf_counter() - start
        return json.dumps(["ok", dict(row), "", seconds], default=_json_value)
    except MemoryError as error:
        return json.dumps(["memory", {}, repr(error), perf_counter() - start])
    except Exception as error:
        return json.dumps(["error", {}, repr(error), perf_counter() - start])


def _json_value(value: Any) -> Any:
    """Converts an array or a scalar of NumPy or JAX to a JSON value."""
    if not hasattr(value, "tolist"):
        raise TypeError(f"a row must hold JSON values and arrays, not {type(value).__name__}")
    return value.tolist()


def main(pipe: str, parent: str, name: str) -> None:
    """Loads the function, then runs every task that arrives until the pipe is closed.

    Sends a message after loading, the traceback if the function could not be loaded and "" otherwise, and then one
    reply per task.
    """
    _die_with(int(parent))
    # a subprocess of a task must not keep the pipe open
    os.set_inheritable(int(pipe), False)
    with Connection(int(pipe)) as connection:
        try:
            function = _load(name)
        except Exception:
            connection.send(traceback.format_exc())
            return
        connection.send("")
        with suppress(EOFError):
            while True:
                connection.send(_reply(function, Task(name, connection.recv())))


if __name__ == "__main__":
    main(*sys.argv[1:])
