"""A process that calls one function for one task after another, and that can be killed during any of them.

The process pools of Python and joblib have no time limit per task, and they break as a whole when one process ends. A
daemonic process, such as a worker of a cluster, may not have children of `multiprocessing`. Hence a plain subprocess.
"""

import json
import os
import platform
import signal
import subprocess
import sys
from contextlib import suppress
from multiprocessing import Pipe
from time import perf_counter, sleep

import psutil

from experiments.execution.limits import Limits
from experiments.execution.result import Result, Status
from experiments.execution.task import Task
from experiments.framework.project import PROJECT
from experiments.framework.tables import Row

STARTS = 3
"""How often the process is started if it dies while it loads the function; an error in loading is final at once."""

LOADING = Limits(seconds=600.0)
"""Limits for loading a function."""

STEP_SECONDS = 0.05
"""Interval of the checks of time and memory; a process can exceed its limit for this long."""

END_SECONDS = 10.0
"""How long to wait for the exit status of a process that has closed its pipe."""

ONE_THREAD = (
    *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"),
    *("NUMBA_NUM_THREADS", "NPROC"),
)
"""Environment variables that set the number of threads of BLAS, of Numba and (the last one) of JAX.

All are set to 1: rounding errors of sums depend on how threads divide them, and times depend on the threads of other
tasks, of which those of Numba wait by spinning.
"""


class Worker:
    """A running worker process that has loaded a function.

    Attributes:
        function: name of the function, `module:function`.
        used: whether the process has run a task.
        alive: whether the process can run another task.
    """

    def __init__(self, function: str):
        """Starts the process; starts it again if it dies before the function is loaded.

        Raises:
            RuntimeError: if the function cannot be loaded.
        """
        self.function, self.used = function, False
        for _ in range(STARTS):
            self._start()
            status, message = self._receive(LOADING)
            if status == "ok":
                break
        if status != "ok" or message:
            self.end()
            raise RuntimeError(f"{function} cannot be loaded: {message}")

    def _start(self) -> None:
        self.alive = True
        self._pipe, theirs = Pipe()
        name = self.function
        command = [sys.executable, "-m", "experiments.execution.serving", str(theirs.fileno()), str(os.getpid()), name]
        with theirs:
            self._process = subprocess.Popen(
                command,
                env=_environment(),
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=2,  # to stderr: stdout is for the runner's own output
                start_new_session=True,  # a process group: killed with its subprocesses, and not by Ctrl-C
            )

    def attempt(self, task: Task, limits: Limits) -> Result:
        """Runs a task, and kills the process if it exceeds a limit. Errors of the task become its result."""
        self.used = True
        start = perf_counter()
        # if the process has died, `_receive` finds out
        with suppress(OSError):
            self._pipe.send(task.parameters)
        status, message = self._receive(limits)
        row: Row = {}
        failure, seconds = message, perf_counter() - start
        if status == "ok":
            status, row, failure, seconds = json.loads(message)
        limit = limits.of(status)
        return Result(task.identity, task.parameters, status, row, failure, seconds, platform.node(), limit=limit)

    def _receive(self, limits: Limits) -> tuple[Status, str]:
        """Waits for a message of the process: returns "ok" and the message, or another status and how it ended."""
        start = perf_counter()
        try:
            while not self._pipe.poll(STEP_SECONDS):
                # a process that a task forked may keep the pipe of a dead process open
                if self._has_died() and not self._pipe.poll(0):
                    return "died", self._exit_reason()
                exceeded = limits.exceeded(perf_counter() - start, self._process.pid)
                if exceeded:
                    self.end()
                    return exceeded
            return "ok", self._pipe.recv()
        except (EOFError, OSError):
            return "died", self._exit_reason()
        except BaseException:
            # otherwise the next task would receive this task's reply
            self.end()
            raise

    def _has_died(self) -> bool:
        # not `Popen.poll`, which frees the process id, and with it the id of the group of its subprocesses
        try:
            return bool(psutil.Process(self._process.pid).status() == psutil.STATUS_ZOMBIE)
        except psutil.NoSuchProcess:
            return True

    def _exit_reason(self) -> str:
        """Returns how the process ended, after killing it and what is left of its group."""
        start = perf_counter()
        while not (died := self._has_died()) and perf_counter() - start < END_SECONDS:
            sleep(STEP_SECONDS)
        self.end()
        code = self._process.returncode
        if not died:
            return "closed its pipe"
        return f"exit status {code}" if code >= 0 else f"killed by signal {-code}: {signal.strsignal(-code)}"

    def kill(self) -> None:
        """Kills the process and the subprocesses of its tasks; a pending `attempt` then returns the status "died"."""
        self.alive = False
        if self._process.returncode is None:
            # macOS refuses signals to a group whose processes have all ended
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)

    def end(self) -> None:
        """Kills the process and releases its resources."""
        self.kill()
        self._process.wait()
        self._pipe.close()


def _environment() -> dict[str, str]:
    # a fixed hash seed: otherwise sets of strings have another order in every process
    path = os.pathsep.join(filter(None, (str(PROJECT), os.environ.get("PYTHONPATH"))))
    return {**os.environ, **dict.fromkeys(ONE_THREAD, "1"), "PYTHONHASHSEED": "0", "PYTHONPATH": path}
