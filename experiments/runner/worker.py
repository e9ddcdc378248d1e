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
from time import perf_counter

from experiments.report import PROJECT, Row
from experiments.runner.limits import Limits
from experiments.runner.result import Result, Status
from experiments.runner.task import Task

START_SECONDS = 600.0
"""Within which a function must be loaded."""

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
        """Starts the process.

        Raises:
            RuntimeError: the function cannot be loaded.
        """
        self.function, self.used, self.alive = function, False, True
        self._pipe, theirs = Pipe()
        command = [sys.executable, "-m", "experiments.runner.serving", str(theirs.fileno()), str(os.getpid()), function]
        with theirs:
            self._process = subprocess.Popen(
                command,
                env=_environment(),
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                stdout=2,  # the runner's own output is not the tasks'
                start_new_session=True,  # a group of its own: killed with its subprocesses, and spared Ctrl-C
            )
        try:
            why = self._pipe.recv() if self._pipe.poll(START_SECONDS) else f"not within {START_SECONDS:g} s"
        except (EOFError, OSError):
            why = self._ended()
        if why:
            self.end()
            raise RuntimeError(f"{function} cannot be loaded: {why}")

    def attempt(self, task: Task, limits: Limits) -> Result:
        """Does a task, and ends the process if it is over a limit. Nothing that a task does is raised here."""
        self.used = True
        start = perf_counter()
        status: Status
        row: Row = {}
        try:
            self._pipe.send(task.parameters)
            exceeded = self._exceeded(start, limits)
            if exceeded is None:
                status, row, failure, seconds = json.loads(self._pipe.recv())
            else:
                (status, failure), seconds = exceeded, perf_counter() - start
                self.end()
        except (EOFError, OSError):
            status, failure, seconds = "died", self._ended(), perf_counter() - start
        except BaseException:
            # its answer would be taken for that of the next task
            self.end()
            raise
        return Result(task.identity, task.parameters, status, row, failure, seconds, platform.node())

    def _exceeded(self, start: float, limits: Limits) -> tuple[Status, str] | None:
        """Waits until a limit is exceeded, or there is an answer or an end of the process (None)."""
        while not self._pipe.poll(STEP_SECONDS):
            exceeded = limits.exceeded(perf_counter() - start, self._process.pid)
            # a subprocess that was forked within the task may keep the pipe of a dead process open
            gone = self._process.poll() is not None and not self._pipe.poll(0)
            if exceeded or gone:
                return None if gone else exceeded
        return None

    def _ended(self) -> str:
        """How the process has ended."""
        try:
            code = self._process.wait(END_SECONDS)
        except subprocess.TimeoutExpired:
            return "closed its pipe"
        finally:
            self.end()
        return f"exit status {code}" if code >= 0 else f"killed by signal {-code}: {signal.strsignal(-code)}"

    def kill(self) -> None:
        """Kills the process and the subprocesses of its tasks; who waits for its answer learns that it has ended."""
        self.alive = False
        if self._process.returncode is None:
            with suppress(ProcessLookupError):
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
