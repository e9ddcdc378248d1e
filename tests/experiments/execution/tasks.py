"""Functions that the tests run as tasks, in worker processes."""

import ctypes
import os
import random
import signal
import subprocess
import time
from pathlib import Path

import numpy as np

DEADLINE = 120.0
"""Seconds to wait for events that should take one or two; only a failure takes so long."""


def drawn(k):
    return {"k": k, "square": k * k, "draws": np.array([random.random(), np.random.random()]), "order": [*{"a", "b"}]}  # noqa: NPY002


def gated(k, folder):
    """Records the processes that run it; tasks from 4 on wait until the file `go` exists."""
    with (Path(folder) / f"mark{k}").open("a") as file:
        file.write(f"{os.getppid()} {os.getpid()}\n")
    while k >= 4 and not (Path(folder) / "go").exists():
        time.sleep(0.02)
    return drawn(k)


def ending(how):
    if how == "raise":
        raise ValueError("no plane")
    if how == "hang":
        # in C, holding the interpreter lock: no signal handler and no other thread of Python can run
        ctypes.PyDLL(None).pause()
    if how == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if how == "exit":
        os._exit(3)
    if how == "object":
        return {"it": object()}
    return {"nan": np.nan}


def hog(megabytes, kept=[]):  # noqa: B006
    taken = 0
    while taken < megabytes:
        kept.append(np.ones(2**21))
        taken += 16
    return {"taken": taken}


def leaving(how, folder):
    """Starts a subprocess that outlives it by far, and ends its own process."""
    if how == "fork":
        child = os.fork()
        if not child:
            time.sleep(2 * DEADLINE)
            os._exit(0)
    else:
        child = subprocess.Popen(["sleep", str(2 * DEADLINE)]).pid
    (Path(folder) / how).write_text(str(child))
    os._exit(3)


def reading(k, folder):
    """Fails until its file exists."""
    return {"k": k, "read": (Path(folder) / f"read{k}").read_text()}
