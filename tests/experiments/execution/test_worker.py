"""Worker processes: subprocesses they leave behind, memory limits, and functions that cannot be loaded."""

import json
import textwrap

import pytest

from experiments.execution import run
from experiments.execution.store import Store
from tests.experiments.execution.processes import here, recorded, running, until
from tests.experiments.execution.tasks import DEADLINE


@pytest.mark.parametrize("how", ["fork", "subprocess"])
def test_subprocesses_of_a_task_end_with_its_process(how, tmp_path, started):
    tasks, results = tmp_path / "tasks.jsonl", tmp_path / "results.jsonl"
    tasks.write_text(json.dumps({"how": how, "folder": str(tmp_path)}) + "\n")
    runner = started("tests.experiments.execution.runner", here("leaving"), tasks, results, json.dumps({"seconds": 60}))
    assert runner.wait(DEADLINE) == 0
    with Store(results) as store:
        assert [(item["status"], item["failure"]) for item in store.items] == [("died", "exit status 3")]
    until(lambda: not running(int((tmp_path / how).read_text())))


def test_the_memory_limit_counts_for_each_task_alone(tmp_path):
    # the middle three together would exceed the limit if they ran in one process
    tasks = [{"megabytes": 200 + k} for k in range(3)]
    tasks = [{"megabytes": 10_000}, *tasks, {"megabytes": 20_000}]
    ended = run(tasks, here("hog"), tmp_path / "results.jsonl", jobs=1, megabytes=500)
    assert [r.status for r in ended] == ["memory", "ok", "ok", "ok", "memory"]
    assert "500 MiB" in ended[0].failure


def test_a_missing_function_stops_the_run(tmp_path):
    for jobs in (1, 2):
        with pytest.raises(RuntimeError, match="absent"):
            run([{"k": 1}, {"k": 2}], here("absent"), tmp_path / "results.jsonl", jobs=jobs)
    assert recorded(tmp_path / "results.jsonl") == 0


@pytest.mark.parametrize(("dying", "starts"), [(2, 3), (9, 3)])
def test_a_process_that_dies_while_loading_is_started_again(dying, starts, tmp_path, monkeypatch):
    loads = tmp_path / "loads"
    text = f"""
        import os
        with open({str(loads)!r}, "a+") as file:
            print(file=file, flush=True)
            file.seek(0)
            if len(file.readlines()) <= {dying}:
                os._exit(9)
        def function(k):
            return {{"k": k}}
    """
    (tmp_path / "dying.py").write_text(textwrap.dedent(text))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    if dying < starts:
        assert run([{"k": 1}], "dying:function", tmp_path / "results.jsonl", jobs=1)[0].row == {"k": 1}
    else:
        with pytest.raises(RuntimeError, match="cannot be loaded: exit status 9"):
            run([{"k": 1}], "dying:function", tmp_path / "results.jsonl", jobs=1)
    assert recorded(loads) == starts


def test_an_error_in_loading_stops_the_run_at_once(tmp_path, monkeypatch):
    (tmp_path / "raising.py").write_text(
        f"print(file=open({str(tmp_path / 'loads')!r}, 'a'))\nraise ValueError('no')\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(RuntimeError, match="ValueError: no"):
        run([{"k": 1}], "raising:function", tmp_path / "results.jsonl", jobs=1)
    assert recorded(tmp_path / "loads") == 1
