"""The runner loses nothing and does nothing twice, whoever is killed, and gives the same whatever runs the tasks."""

import ctypes
import json
import os
import random
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")

import psutil

from experiments.execution import run
from experiments.execution.store import Store
from experiments.execution.task import Task
from experiments.framework import study
from experiments.framework.study import PROJECT

DEADLINE = 120.0
"""Seconds for what should take one or two: only a failure takes so long."""


def drawn(k):
    return {"k": k, "square": k * k, "draws": np.array([random.random(), np.random.random()]), "order": [*{"a", "b"}]}  # noqa: NPY002


def gated(k, folder):
    """Leaves a mark of who does it; the later ones wait until they may end."""
    with (Path(folder) / f"mark{k}").open("a") as file:
        file.write(f"{os.getppid()} {os.getpid()}\n")
    while k >= 4 and not (Path(folder) / "go").exists():
        time.sleep(0.02)
    return drawn(k)


def ending(how):
    if how == "raise":
        raise ValueError("no plane")
    if how == "hang":
        # in C, with the interpreter's lock: no signal handler and no thread of Python runs any more
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
    """Leaves a subprocess behind that outlives it by far, and ends its process."""
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
    """Fails until its file is there."""
    return {"k": k, "read": (Path(folder) / f"read{k}").read_text()}


def here(function):
    return f"tests.test_runner:{function}"


def lines(path):
    """The lines of results, sorted, timings aside."""
    return sorted(json.dumps(json.loads(line) | {"seconds": 0}) for line in path.read_text().splitlines())


def until(happened):
    start = time.monotonic()
    while not happened():
        assert time.monotonic() - start < DEADLINE
        time.sleep(0.02)


class Mark(NamedTuple):
    """The processes that a task was begun in: that of the runner or of the cluster, and the task's own."""

    parent: int
    task: int


def marks(folder, k):
    """A mark for every time that a task was begun."""
    path = folder / f"mark{k}"
    return [Mark(*map(int, line.split())) for line in path.read_text().splitlines()] if path.exists() else []


def running(pid):
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def recorded(path):
    return path.read_bytes().count(b"\n") if path.exists() else 0


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
    """Starts a scheduler and processes of a cluster, and says the address."""
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
    """Gated tasks, their file, and the results of a run that nothing disturbs."""
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


def test_a_task_is_known_by_its_values():
    task = Task("m:f", {"a": 1, "b": [0.1, "x"]})
    assert task.identity == Task("m:f", {"b": [0.1, "x"], "a": 1}).identity
    others = [Task("m:g", task.parameters), Task("m:f", {"a": 2, "b": [0.1, "x"]}), Task("m:f", {"a": 1})]
    assert len({task.identity, *(other.identity for other in others)}) == 4
    # in a file of last year too
    assert Task("m:f", {"a": 1}).identity == "ab8b79db396dba24"
    with pytest.raises(ValueError, match="not JSON compliant"):
        _ = Task("m:f", {"a": np.nan}).identity


def test_a_file_cut_anywhere_in_its_last_line_loses_only_that_line(tmp_path):
    path = tmp_path / "lines.jsonl"
    items = [{"a": 1}, {"b": "é\n", "c": [None, 0.1]}]
    with Store(path) as store:
        for item in items:
            store.append(item)
    whole = path.read_bytes()
    first = whole.index(b"\n") + 1
    for cut in range(len(whole) + 1):
        path.write_bytes(whole[:cut])
        kept = items[: (cut >= first - 1) + (cut >= len(whole) - 1)]
        with Store(path) as store:
            assert store.items == kept
            store.append({"new": cut})
        with Store(path) as store:
            assert store.items == [*kept, {"new": cut}]
    path.write_bytes(whole[:first] + b"\0\0\0")
    with Store(path) as store:
        assert store.items == items[:1]


def test_a_file_of_something_else_is_left_alone(tmp_path):
    path = tmp_path / "lines.jsonl"
    path.write_text('{"a": 1}\nsome text\n{"a": 2}\n')
    with pytest.raises(ValueError, match="line 2 is no JSON object"):
        Store(path)
    assert path.read_text().count("\n") == 3
    path.write_text('{"a": 1}\n')
    with pytest.raises(ValueError, match="no result"):
        run([{"k": 1}], here("drawn"), path)


def test_a_file_has_one_writer(tmp_path):
    with Store(tmp_path / "lines.jsonl"), pytest.raises(RuntimeError, match="another process"):
        Store(tmp_path / "lines.jsonl")
    with Store(tmp_path / "lines.jsonl") as store:
        assert store.items == []


def test_one_worker_gives_what_three_give(tmp_path):
    tasks = [{"k": k} for k in range(12)]
    one = run(tasks, here("drawn"), tmp_path / "one.jsonl", jobs=1)
    three = run(tasks[::-1], here("drawn"), tmp_path / "three.jsonl", jobs=3)
    assert lines(tmp_path / "one.jsonl") == lines(tmp_path / "three.jsonl")
    assert [r.row for r in one] == [r.row for r in three[::-1]]
    assert [r.columns["square"] for r in one] == [k * k for k in range(12)]
    # every task draws its own
    assert len({r.row["draws"][0] for r in one}) == 12


def test_results_come_from_the_file_where_it_has_them(tmp_path):
    path = tmp_path / "results.jsonl"
    run([{"k": 1}, {"k": 2}], here("drawn"), path, jobs=1)
    before = path.read_bytes()
    again = run([{"k": 2}, {"k": 3}, {"k": 2}], here("drawn"), path, jobs=1)
    assert [r.row["k"] for r in again] == [2, 3, 2]
    assert path.read_bytes().startswith(before)
    assert recorded(path) == 3
    with Store(tmp_path / "results.runs.jsonl") as runs:
        assert [about["results_before"] for about in runs.items] == [0, 2]
        assert all({"commit", "versions", "machine", "command", "started"} <= set(about) for about in runs.items)
        assert runs.items[0]["config"]["function"] == here("drawn")


def test_whatever_a_task_does_is_recorded_and_the_run_goes_on(tmp_path):
    hows = ("raise", "hang", "crash", "exit", "object", "return")
    ended = run([{"how": how} for how in hows], here("ending"), tmp_path / "results.jsonl", jobs=2, seconds=5)
    assert [r.status for r in ended] == ["error", "timeout", "died", "died", "error", "ok"]
    for result, word in zip(ended, ("no plane", "5 s", "signal 11", "status 3", "a object", ""), strict=True):
        assert word in result.failure
    assert all(r.row == {} for r in ended[:-1])
    assert [r.limit for r in ended] == [None, 5, None, None, None, None]
    # done: it does not hang again
    assert run([{"how": "hang"}], here("ending"), tmp_path / "results.jsonl", seconds=5) == [ended[1]]


@pytest.mark.parametrize("how", ["fork", "subprocess"])
def test_what_a_task_leaves_behind_ends_with_its_process(how, tmp_path, started):
    tasks, results = tmp_path / "tasks.jsonl", tmp_path / "results.jsonl"
    tasks.write_text(json.dumps({"how": how, "folder": str(tmp_path)}) + "\n")
    assert started("experiments.execution", here("leaving"), tasks, results, "--seconds", 60).wait(DEADLINE) == 0
    with Store(results) as store:
        assert [(item["status"], item["failure"]) for item in store.items] == [("died", "exit status 3")]
    until(lambda: not running(int((tmp_path / how).read_text())))


def test_what_a_limit_ended_is_done_again_under_a_larger_one(tmp_path):
    path = tmp_path / "results.jsonl"
    short = run([{"how": "hang"}], here("ending"), path, seconds=2)
    assert run([{"how": "hang"}], here("ending"), path, seconds=1) == short
    assert run([{"how": "hang"}], here("ending"), path, seconds=3)[0].limit == 3
    assert recorded(path) == 2
    for megabytes, status in ((300, "memory"), (200, "memory"), (None, "ok"), (300, "ok")):
        assert [r.status for r in run([{"megabytes": 400}], here("hog"), path, megabytes=megabytes)] == [status]
    assert recorded(path) == 4
    # a line of before limits were written
    old = json.loads(path.read_text().splitlines()[0])
    del old["limit"]
    path.write_text(json.dumps(old) + "\n")
    assert [r.limit for r in run([{"how": "hang"}], here("ending"), path, seconds=3)] == [None]


def test_an_error_is_no_end(tmp_path):
    path, folder = tmp_path / "results.jsonl", str(tmp_path)
    tasks = [{"k": k, "folder": folder} for k in range(3)]
    (tmp_path / "read1").write_text("one")
    run(tasks, here("reading"), path, jobs=1)
    calm = lines(path)
    whole = path.read_text().splitlines(keepends=True)
    # killed at any moment, the errors too are there once
    for kept in range(3):
        path.write_text("".join(whole[:kept]))
        assert [r.status for r in run(tasks, here("reading"), path, jobs=1)] == ["error", "ok", "error"]
        assert lines(path) == calm
    (tmp_path / "read0").write_text("zero")
    for _ in range(2):
        assert [r.status for r in run(tasks, here("reading"), path, jobs=1)] == ["ok", "ok", "error"]
        assert recorded(path) == 4


def test_results_of_other_code_are_used_loudly(tmp_path, monkeypatch, capsys):
    path, tasks = tmp_path / "results.jsonl", [{"k": k} for k in range(4)]
    asked = []
    for commit, most in (("a" * 40, 2), ("b" * 40 + "+", 3)):
        monkeypatch.setattr(study, "_commit", lambda commit=commit: asked.append(commit) or commit)
        run(tasks[:2], here("drawn"), path, jobs=1)
        assert [r.commit for r in run(tasks[:most], here("drawn"), path, jobs=1)][most - 1] == commit
        said = capsys.readouterr().err
    assert said.count("OTHER CODE") == 2
    assert "2 OF 2 RESULTS USED ARE OF OTHER CODE than bbbbbbbbb+: 2 of aaaaaaaaa;" in said
    # once a run, not a task
    assert len(asked) == 4
    first, *others = path.read_text().splitlines(keepends=True)
    old = {name: value for name, value in json.loads(first).items() if name not in ("commit", "limit")}
    path.write_text("".join([json.dumps(old) + "\n", *others]))
    assert [r.commit[:1] for r in run(tasks[:3], here("drawn"), path, jobs=1)] == ["", "a", "b"]
    assert "2 OF 3 RESULTS USED" in (said := capsys.readouterr().err)
    assert "1 of an unknown commit" in said
    run(tasks[2:3], here("drawn"), path, jobs=1)
    assert "OTHER CODE" not in capsys.readouterr().err


def test_a_task_is_held_to_its_own_memory(tmp_path):
    # the middle three together leave in their process more than one may take
    tasks = [{"megabytes": 200 + k} for k in range(3)]
    tasks = [{"megabytes": 10_000}, *tasks, {"megabytes": 20_000}]
    ended = run(tasks, here("hog"), tmp_path / "results.jsonl", jobs=1, megabytes=500)
    assert [r.status for r in ended] == ["memory", "ok", "ok", "ok", "memory"]
    assert "500 MiB" in ended[0].failure


def test_a_function_that_is_not_there_stops_the_run(tmp_path):
    for jobs in (1, 2):
        with pytest.raises(RuntimeError, match="absent"):
            run([{"k": 1}, {"k": 2}], here("absent"), tmp_path / "results.jsonl", jobs=jobs)
    assert recorded(tmp_path / "results.jsonl") == 0


@pytest.mark.parametrize(("dying", "starts"), [(2, 3), (9, 3)])
def test_a_process_that_ends_while_it_loads_is_started_again(dying, starts, tmp_path, monkeypatch):
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


def test_a_function_that_raises_while_it_loads_is_given_up_at_once(tmp_path, monkeypatch):
    (tmp_path / "raising.py").write_text(
        f"print(file=open({str(tmp_path / 'loads')!r}, 'a'))\nraise ValueError('no')\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(RuntimeError, match="ValueError: no"):
        run([{"k": 1}], "raising:function", tmp_path / "results.jsonl", jobs=1)
    assert recorded(tmp_path / "loads") == 1


def test_a_killed_runner_goes_on_where_it_was(tmp_path, listed, started):
    tasks, path, calm = listed
    results = tmp_path / "results.jsonl"
    runner = started("experiments.execution", here("gated"), path, results, "--jobs", 2)
    until(lambda: recorded(results) == 4 and marks(tmp_path, 4) and marks(tmp_path, 5))
    runner.kill()
    runner.wait()
    if sys.platform == "linux":
        # tasks that would never return end with their runner
        until(lambda: not any(running(mark.task) for k in (4, 5) for mark in marks(tmp_path, k)))
    (tmp_path / "go").touch()
    with results.open("a") as file:
        file.write('{"identity": "0123')
    run(tasks, here("gated"), results, jobs=3)
    assert lines(results) == calm
    assert [len(marks(tmp_path, k)) for k in range(8)] == [1, 1, 1, 1, 2, 2, 1, 1]


@pytest.mark.parametrize("runner_too", [False, True])
def test_a_killed_worker_of_a_cluster_changes_nothing(runner_too, tmp_path, listed, started, cluster):
    _, path, calm = listed
    results = tmp_path / "results.jsonl"
    command = ("experiments.execution", here("gated"), path, results, "--dask", cluster(2))
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


def test_a_cluster_keeps_no_old_code_from_a_killed_run(tmp_path, started, cluster):
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
    command = ("experiments.execution", "changing:function", tasks, results, "--dask", address)
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
