"""The tasks of the comparison, and runs that continue from earlier results."""

import dataclasses
import json

import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")


from experiments.comparison import plan
from experiments.comparison.curves import shares
from experiments.comparison.leaderboard import MEASURES, measures_of
from experiments.data import corruptions
from experiments.execution.result import Result
from experiments.framework.run_study import run_study
from experiments.studies.paper import arena, sweeps
from experiments.studies.robust.robustness import TARGETS
from tests.experiments.comparison.rows import row

TINY = [
    *("--size", "small", "--num-points", "300", "--jobs", "1"),
    *("--methods", "pca,ransac-released,cicconet", "--conditions", "clean,out40"),
]


def test_the_sweeps_add_conditions_and_keep_the_others():
    assert ",".join(corruptions.CONDITIONS) == corruptions.CONDITION_NAMES
    assert set(TARGETS) == set(corruptions.CONDITIONS)
    every = plan.ALL.split(",")
    assert len(every) == len(set(every)) == 14
    assert list(shares(every, "outliers").values()) == [0, 20, 40, 60, 80, 100, 120]
    assert list(shares(every, "missing").values()) == pytest.approx([0, 15, 20, 28, 40])


def test_a_task_over_its_limit_is_a_miss_and_takes_its_object_from_another_method():
    task = {
        name: row()[name] for name in ("method", "benchmark", "item", "name", "condition", "seed", "num_points", "data")
    }
    done = {name: value for name, value in row(truths=[[1.0, 0, 0, 0], [0, 1.0, 0, 0]]).items() if name not in task}
    ok = Result("a", task, "ok", done, "", 1.0, "host")
    hung = Result("b", task | {"method": "hruda"}, "timeout", {}, "more than 9 s", 9.1, "host")
    alone = Result("c", task | {"item": 7}, "died", {}, "killed", 3.0, "host")
    absent = Result("d", task | {"item": 8}, "error", {}, "DATA IS ABSENT", 0.1, "host")
    one, two, three = plan.rows_of([ok, hung, alone, absent])
    assert two["truths"] == one["truths"]
    assert (two["angle"], two["seconds"], two["raised"]) == (90.0, 9.1, "timeout: more than 9 s")
    assert len(three["truths"]) == 1
    assert measures_of([two, three])["hit rate"] == 0.0


def test_stored_results_with_the_former_name_of_a_column_can_be_read():
    task = {
        name: row()[name] for name in ("method", "benchmark", "item", "name", "condition", "seed", "num_points", "data")
    }
    values = {"held" if name == "accepted" else name: value for name, value in row().items() if name not in task}
    line = {"identity": "a", "task": task, "status": "ok", "row": values, "failure": "", "seconds": 1.0, "host": "h"}
    rows = plan.rows_of([Result(**json.loads(json.dumps(line)))])
    assert rows == [row()]
    assert measures_of(rows)["F"] == 1.0


def stripped(path):
    """Returns the sorted lines of a file of results, without the timings."""
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:
        del line["seconds"], line["row"]["seconds"]
    return sorted(json.dumps(line, sort_keys=True) for line in lines)


def test_a_killed_run_and_the_other_studies_continue_from_the_file_of_results(tmp_path, capsys):
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    undrawn = dataclasses.replace(arena.STUDY, draw=None)
    assert run_study(undrawn, [*TINY, "--objects", "2", "--out", str(whole)]) == 0
    assert run_study(undrawn, [*TINY, "--objects", "1", "--out", str(broken)]) == 0
    results = broken / plan.RESULTS
    kept = results.read_bytes()
    assert kept.count(b"\n") == 6
    # killed within the last line
    results.write_bytes(kept[:-40])
    plan.outcomes.cache_clear()
    assert run_study(undrawn, [*TINY, "--objects", "2", "--out", str(broken)]) == 0
    assert results.read_bytes().startswith(kept[: kept[:-1].rindex(b"\n") + 1])
    assert stripped(results) == stripped(whole / plan.RESULTS)
    done = results.read_bytes()
    for study in (arena.STUDY, sweeps.OUTLIERS):
        plan.outcomes.cache_clear()
        assert run_study(study, [*TINY, "--objects", "2", "--out", str(broken)]) == 0
        assert results.read_bytes() == done
        assert "the paper, published" in (broken / f"{study.name}.md").read_text()
        assert (broken / f"{study.name}.pdf").read_bytes().startswith(b"%PDF")
    text = (broken / "arena.md").read_text()
    assert "procedural-1354 (2 objects)" in text
    assert all(measure.title in text for measure in MEASURES.values())
    assert "arena (small)" in capsys.readouterr().out
