"""A run gives the same results on any number of workers, and repeats no finished task."""

import json

from experiments.execution import run
from experiments.execution.store import Store
from experiments.framework import provenance
from tests.experiments.execution.processes import here, lines, recorded


def test_one_worker_gives_what_three_give(tmp_path):
    tasks = [{"k": k} for k in range(12)]
    one = run(tasks, here("drawn"), tmp_path / "one.jsonl", jobs=1)
    three = run(tasks[::-1], here("drawn"), tmp_path / "three.jsonl", jobs=3)
    assert lines(tmp_path / "one.jsonl") == lines(tmp_path / "three.jsonl")
    assert [r.row for r in one] == [r.row for r in three[::-1]]
    assert [r.columns["square"] for r in one] == [k * k for k in range(12)]
    # every task draws its own numbers
    assert len({r.row["draws"][0] for r in one}) == 12


def test_tasks_with_a_result_in_the_file_are_not_run_again(tmp_path):
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


def test_every_way_to_fail_is_recorded_and_the_run_goes_on(tmp_path):
    hows = ("raise", "hang", "crash", "exit", "object", "return")
    ended = run([{"how": how} for how in hows], here("ending"), tmp_path / "results.jsonl", jobs=2, seconds=5)
    assert [r.status for r in ended] == ["error", "timeout", "died", "died", "error", "ok"]
    for result, word in zip(ended, ("no plane", "5 s", "signal 11", "status 3", "not object", ""), strict=True):
        assert word in result.failure
    assert all(r.row == {} for r in ended[:-1])
    assert [r.limit for r in ended] == [None, 5, None, None, None, None]
    # it has its result, and does not hang again
    assert run([{"how": "hang"}], here("ending"), tmp_path / "results.jsonl", seconds=5) == [ended[1]]


def test_a_task_that_exceeded_a_limit_is_repeated_under_a_larger_one(tmp_path):
    path = tmp_path / "results.jsonl"
    short = run([{"how": "hang"}], here("ending"), path, seconds=2)
    assert run([{"how": "hang"}], here("ending"), path, seconds=1) == short
    assert run([{"how": "hang"}], here("ending"), path, seconds=3)[0].limit == 3
    assert recorded(path) == 2
    for megabytes, status in ((300, "memory"), (200, "memory"), (None, "ok"), (300, "ok")):
        assert [r.status for r in run([{"megabytes": 400}], here("hog"), path, megabytes=megabytes)] == [status]
    assert recorded(path) == 4
    # a line from before limits were recorded
    old = json.loads(path.read_text().splitlines()[0])
    del old["limit"]
    path.write_text(json.dumps(old) + "\n")
    assert [r.limit for r in run([{"how": "hang"}], here("ending"), path, seconds=3)] == [None]


def test_a_task_that_failed_with_an_error_is_repeated(tmp_path):
    path, folder = tmp_path / "results.jsonl", str(tmp_path)
    tasks = [{"k": k, "folder": folder} for k in range(3)]
    (tmp_path / "read1").write_text("one")
    run(tasks, here("reading"), path, jobs=1)
    calm = lines(path)
    whole = path.read_text().splitlines(keepends=True)
    # a run that was killed at any moment records every error once, too
    for kept in range(3):
        path.write_text("".join(whole[:kept]))
        assert [r.status for r in run(tasks, here("reading"), path, jobs=1)] == ["error", "ok", "error"]
        assert lines(path) == calm
    (tmp_path / "read0").write_text("zero")
    for _ in range(2):
        assert [r.status for r in run(tasks, here("reading"), path, jobs=1)] == ["ok", "ok", "error"]
        assert recorded(path) == 4


def test_results_of_other_commits_are_used_with_a_warning(tmp_path, monkeypatch, capsys):
    path, tasks = tmp_path / "results.jsonl", [{"k": k} for k in range(4)]
    asked = []
    for commit, most in (("a" * 40, 2), ("b" * 40 + "+", 3)):
        monkeypatch.setattr(provenance, "current_commit", lambda commit=commit: asked.append(commit) or commit)
        run(tasks[:2], here("drawn"), path, jobs=1)
        assert [r.commit for r in run(tasks[:most], here("drawn"), path, jobs=1)][most - 1] == commit
        warning = capsys.readouterr().err
    assert warning.count("OTHER CODE") == 2
    assert "2 OF 2 RESULTS USED ARE OF OTHER CODE than bbbbbbbbb+: 2 of aaaaaaaaa;" in warning
    # once per run, not per task
    assert len(asked) == 4
    first, *others = path.read_text().splitlines(keepends=True)
    old = {name: value for name, value in json.loads(first).items() if name not in ("commit", "limit")}
    path.write_text("".join([json.dumps(old) + "\n", *others]))
    assert [r.commit[:1] for r in run(tasks[:3], here("drawn"), path, jobs=1)] == ["", "a", "b"]
    assert "2 OF 3 RESULTS USED" in (warning := capsys.readouterr().err)
    assert "1 of an unknown commit" in warning
    run(tasks[2:3], here("drawn"), path, jobs=1)
    assert "OTHER CODE" not in capsys.readouterr().err
