"""Fixtures for runs that are killed: processes, a cluster, and the results of an undisturbed run."""

import json
import os
import subprocess
import sys

import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")

from experiments.execution import run
from experiments.framework.project import PROJECT
from tests.experiments.execution.processes import here, lines, until


@pytest.fixture
def started(tmp_path):
    """Starts modules as processes that are killed when the test ends."""
    processes = []

    def start(*command):
        env = {**os.environ, "PYTHONPATH": f"{PROJECT}{os.pathsep}{tmp_path}", "PYTHONDONTWRITEBYTECODE": "1"}
        with (tmp_path / f"log{len(processes)}").open("w") as log:
            command = [sys.executable, "-m", *map(str, command)]
            processes.append(subprocess.Popen(command, cwd=PROJECT, env=env, stdout=log, stderr=log))
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.wait()


@pytest.fixture
def cluster(tmp_path, started):
    """Starts a scheduler and `count` workers of a cluster; returns the address."""
    pytest.importorskip("distributed", reason="runs on a cluster need dask.distributed")

    def start(count):
        about = tmp_path / "scheduler.json"
        scheduler = ("--host", "127.0.0.1", "--port", 0, "--no-dashboard", "--scheduler-file", about)
        started("distributed.cli.dask_scheduler", *scheduler)
        until(about.exists)
        address = json.loads(about.read_text())["address"]
        for _ in range(count):
            started("distributed.cli.dask_worker", address, "--no-dashboard", "--nthreads", 1, "--no-nanny")
        return address

    return start


@pytest.fixture
def listed(tmp_path):
    """Gated tasks, their file, and the results of an undisturbed run."""
    calm = tmp_path / "calm"
    tasks = [{"k": k, "folder": str(tmp_path)} for k in range(8)]
    path = tmp_path / "tasks.jsonl"
    path.write_text("".join(json.dumps(task) + "\n" for task in tasks))
    (tmp_path / "go").touch()
    run(tasks, here("gated"), calm, jobs=2)
    (tmp_path / "go").unlink()
    for mark in tmp_path.glob("mark*"):
        mark.unlink()
    return tasks, path, lines(calm)
