"""Inside a task's process: loads a function and calls it for one task after another, as the other end of a pipe asks.

Started by `experiments.execution.worker`: `python -m experiments.execution.serving PIPE PARENT module:function`.
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
"""From Linux's `sys/prctl.h`."""


def _bind(parent: int) -> None:
    """Ends this process with the one that started it, even within C; elsewhere than on Linux, after the task."""
    if sys.platform != "linux":
        return
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:
        sys.exit()
    # where the machine's memory runs out, the kernel should take a task rather than the runner
    with suppress(OSError):
        Path("/proc/self/oom_score_adj").write_text("1000")


def _loaded(name: str) -> Callable[..., dict[str, Any]]:
    module, _, function = name.partition(":")
    return getattr(importlib.import_module(module), function)


def _reply(function: Callable[..., dict[str, Any]], task: Task) -> str:
    """Status, row, failure and seconds of a call, as JSON."""
    # for those who draw from the global generators: what they draw must not depend on the tasks before
    random.seed(task.seed)
    np.random.seed(task.seed)  # noqa: NPY002
    start = perf_counter()
    try:
        row = function(**task.parameters)
        seconds = perf_counter() - start
        return json.dumps(["ok", dict(row), "", seconds], default=_plain)
    except MemoryError as error:
        return json.dumps(["memory", {}, repr(error), perf_counter() - start])
    except Exception as error:
        return json.dumps(["error", {}, repr(error), perf_counter() - start])


def _plain(value: Any) -> Any:
    """Arrays and their scalars, NumPy's and JAX's, as JSON values."""
    if not hasattr(value, "tolist"):
        raise TypeError(f"a {type(value).__name__} in a row is no JSON value")
    return value.tolist()


def main(pipe: str, parent: str, name: str) -> None:
    """The process: says "" or why the function cannot be loaded, then answers every task until the pipe is closed."""
    _bind(int(parent))
    # a subprocess of a task must not keep the pipe open
    os.set_inheritable(int(pipe), False)
    with Connection(int(pipe)) as asked:
        try:
            function = _loaded(name)
        except Exception:
            asked.send(traceback.format_exc())
            return
        asked.send("")
        with suppress(EOFError):
            while True:
                asked.send(_reply(function, Task(name, asked.recv())))


if __name__ == "__main__":
    main(*sys.argv[1:])
