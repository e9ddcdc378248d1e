"""Killing the runner or a worker loses no result and repeats no finished task."""

import json
import os
import signal
import sys
import textwrap

import pytest

from experiments.execution import run
from experiments.execution.store import Store
from tests.experiments.execution.processes import here, lines, marks, recorded, running, until
from tests.experiments.execution.tasks import DEADLINE


def test_a_killed_runner_resumes(tmp_path, listed, started):
    tasks, path, calm = listed
    results = tmp_path / "results.jsonl"
    runner = started("tests.experiments.execution.runner", here("gated"), path, results, json.dumps({"jobs": 2}))
    until(lambda: recorded(results) == 4 and marks(tmp_path, 4) and marks(tmp_path, 5))
    runner.kill()
    runner.wait()
    if sys.platform == "linux":
        # tasks that would never return are killed with their runner
        until(lambda: not any(running(mark.task) for k in (4, 5) for mark in marks(tmp_path, k)))
    (tmp_path / "go").touch()
    with results.open("a") as file:
        file.write('{"identity": "0123')
    run(tasks, here("gated"), results, jobs=3)
    assert lines(results) == calm
    assert [len(marks(tmp_path, k)) for k in range(8)] == [1, 1, 1, 1, 2, 2, 1, 1]


@pytest.mark.parametrize("runner_too", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_killed_worker_of_a_cluster_changes_nothing(runner_too, tmp_path, listed, started, cluster):
    _, path, calm = listed
    results = tmp_path / "results.jsonl"
    command = ("tests.experiments.execution.runner", here("gated"), path, results, json.dumps({"dask": cluster(2)}))
    runner = started(*command)
    waiting: list[int] = []

    def stuck():
        waiting[:] = [k for k in range(4, 8) if marks(tmp_path, k)]
        return len(waiting) == 2 and recorded(results) == sum(bool(marks(tmp_path, k)) for k in range(4))

    until(stuck)
    done = [k for k in range(4) if marks(tmp_path, k)]
    worker = marks(tmp_path, waiting[0])[0].parent
    os.kill(worker, signal.SIGKILL)
    until(lambda: not running(worker))
    if runner_too:
        runner.kill()
        runner.wait()
        runner = started(*command)
    (tmp_path / "go").touch()
    assert runner.wait(DEADLINE) == 0
    assert lines(results) == calm
    assert [len(marks(tmp_path, k)) for k in done] == [1] * len(done)
    assert len(marks(tmp_path, waiting[0])) == 2


def test_a_cluster_does_not_run_the_old_code_of_a_killed_run(tmp_path, started, cluster):
    go, begun = tmp_path / "go", tmp_path / "begun"
    old = f"""
        import pathlib, time
        def function(k):
            pathlib.Path({str(begun)!r}).touch()
            while not pathlib.Path({str(go)!r}).exists():
                time.sleep(0.02)
            return {{"code": "old"}}
    """
    module, tasks, results = tmp_path / "changing.py", tmp_path / "tasks.jsonl", tmp_path / "results.jsonl"
    module.write_text(textwrap.dedent(old))
    tasks.write_text('{"k": 1}\n')
    address = cluster(1)
    command = ("tests.experiments.execution.runner", "changing:function", tasks, results, json.dumps({"dask": address}))
    killed = started(*command)
    until(begun.exists)
    killed.kill()
    killed.wait()
    module.write_text("def function(k):\n    return {'code': 'new'}\n")
    runner = started(*command)
    until(lambda: (tmp_path / "results.runs.jsonl").exists() and recorded(tmp_path / "results.runs.jsonl") == 2)
    go.touch()
    assert runner.wait(DEADLINE) == 0
    with Store(results) as store:
        assert [item["row"] for item in store.items] == [{"code": "new"}]
