"""A process that calls one function for one task after another, and can be killed in any of them.

A pool of Python's or joblib's cannot: it knows no time limit a task, and breaks as a whole when a process of it ends.
Nor may a daemonic process, such as that of a cluster, have children of `multiprocessing`: a plain subprocess it is.
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
"""Processes that may end while they load a function; a function that raises then is given up at once."""

LOADING = Limits(seconds=600.0)
"""Of a function."""

STEP_SECONDS = 0.05
"""Between two looks at the memory: what is taken meanwhile comes on top of the limit."""

END_SECONDS = 10.0
"""Within which a process that no longer answers must have ended by itself."""

ONE_THREAD = (
    *("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS", "VECLIB_MAXIMUM_THREADS"),
    *("NUMBA_NUM_THREADS", "NPROC"),
)
"""What BLAS, Numba and, the last, JAX take the number of their threads from.

Sums of floats depend on how threads share them, and times on the threads of the other tasks; those of Numba wait by
spinning.
"""


class Worker:
    """The process, loaded with a function.

    Attributes:
        function: `module:function`.
        used: whether it has had a task.
        alive: whether it can have another.
    """

    def __init__(self, function: str):
        """Starts the process, and again if it ends before it says whether the function is loaded.

        Raises:
            RuntimeError: the function cannot be loaded.
        """
        self.function, self.used = function, False
        for _ in range(STARTS):
            self._start()
            status, said = self._answer(LOADING)
            if status == "ok":
                break
        if status != "ok" or said:
            self.end()
            raise RuntimeError(f"{function} cannot be loaded: {said}")

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
                stdout=2,  # the runner's own output is not the tasks'
                start_new_session=True,  # a group of its own: killed with its subprocesses, and spared Ctrl-C
            )

    def attempt(self, task: Task, limits: Limits) -> Result:
        """Does a task, and ends the process if it is over a limit. Nothing that a task does is raised here."""
        self.used = True
        start = perf_counter()
        # a process that has ended says so when its answer is waited for
        with suppress(OSError):
            self._pipe.send(task.parameters)
        status, said = self._answer(limits)
        row: Row = {}
        failure, seconds = said, perf_counter() - start
        if status == "ok":
            status, row, failure, seconds = json.loads(said)
        limit = limits.of(status)
        return Result(task.identity, task.parameters, status, row, failure, seconds, platform.node(), limit=limit)

    def _answer(self, limits: Limits) -> tuple[Status, str]:
        """What the process says ("ok"), or how it has ended; with anything but "ok" it has."""
        start = perf_counter()
        try:
            while not self._pipe.poll(STEP_SECONDS):
                # what was forked within a task may keep the pipe of a dead process open
                if self._gone() and not self._pipe.poll(0):
                    return "died", self._ended()
                exceeded = limits.exceeded(perf_counter() - start, self._process.pid)
                if exceeded:
                    self.end()
                    return exceeded
            return "ok", self._pipe.recv()
        except (EOFError, OSError):
            return "died", self._ended()
        except BaseException:
            # its answer would be taken for that of the next task
            self.end()
            raise

    def _gone(self) -> bool:
        # not by `poll`, which frees the number of the process, and with it that of the group of its subprocesses
        try:
            return psutil.Process(self._process.pid).status() == psutil.STATUS_ZOMBIE
        except psutil.NoSuchProcess:
            return True

    def _ended(self) -> str:
        """How the process has ended; what is left of it ends too."""
        start = perf_counter()
        while not (gone := self._gone()) and perf_counter() - start < END_SECONDS:
            sleep(STEP_SECONDS)
        self.end()
        code = self._process.returncode
        if not gone:
            return "closed its pipe"
        return f"exit status {code}" if code >= 0 else f"killed by signal {-code}: {signal.strsignal(-code)}"

    def kill(self) -> None:
        """Kills the process and the subprocesses of its tasks; who waits for its answer learns that it has ended."""
        self.alive = False
        if self._process.returncode is None:
            # macOS permits no signal to a group whose processes have all ended
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)

    def end(self) -> None:
        """Kills the process and frees what it held."""
        self.kill()
        self._process.wait()
        self._pipe.close()


def _environment() -> dict[str, str]:
    # strings must hash alike in every process, or sets of them differ in order
    path = os.pathsep.join(filter(None, (str(PROJECT), os.environ.get("PYTHONPATH"))))
    return {**os.environ, **dict.fromkeys(ONE_THREAD, "1"), "PYTHONHASHSEED": "0", "PYTHONPATH": path}
