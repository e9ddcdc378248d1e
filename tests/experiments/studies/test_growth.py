"""Run time as clouds grow: exponents of power laws, and methods that exceed their limit."""

import pytest

from experiments.execution.result import Result
from experiments.studies.paper import growth


def test_the_exponent_of_a_power_law_is_recovered_without_the_small_models():
    seconds = {size: 1e-5 * size**1.3 for size in (5_000, 20_000, 300_000)}
    assert growth.exponent(seconds | {growth.VERTICES: 100.0}) == pytest.approx(1.3)


def test_one_size_has_no_exponent():
    assert growth.exponent({growth.VERTICES: 1.0, 5_000: 2.0}) == "-"


def test_the_exponents_of_the_published_times_are_near_those_between_the_first_and_last_size():
    # log(61.01 / 0.38) / log 60 and log(12.92 / 2.15) / log 60
    assert growth.exponent(growth.PUBLISHED["3DSymm"]) == pytest.approx(1.24, abs=0.15)
    assert growth.exponent(growth.PUBLISHED["the paper's"]) == pytest.approx(0.44, abs=0.06)


class Stub:
    """A worker in which Hruda times out above 5 000 points, and all else takes 1 s per thousand points."""

    def __init__(self, function):
        self.alive = True

    def attempt(self, task, limits):
        size = task.parameters["size"]
        if task.parameters["method"] == "hruda" and size > 5_000:
            self.alive = False
            return Result("", {}, "timeout", {}, f"more than {limits.seconds:g} s", 9.0, "")
        return Result("", {}, "ok", {"seconds": size / 1000, "angle": 1.0}, "", 9.0, "")

    def end(self):
        self.alive = False


def test_a_call_over_the_limit_ends_its_method_and_no_other(tmp_path, monkeypatch):
    monkeypatch.setattr(growth, "Worker", Stub)
    config = growth.Config(sizes="1042,5000,10000,50000", repeats=2, methods="hruda,pca", seconds=7.0)
    rows = growth.run(config)
    slow = [(row["points"], row["status"]) for row in rows if row["method"] == "hruda"]
    assert slow == [*[(1042, "ok")] * 2, *[(5000, "ok")] * 2, (10_000, "timeout")]
    lines = {line["method"]: line for line in growth.summary(rows)}
    hruda, pca = (lines[growth.METHODS[name].title] for name in ("hruda", "pca"))
    assert [hruda[f"{size} points, s"] for size in (5000, 10_000, 50_000)] == [5.0, "more than 7 s", "not tried"]
    assert pca["50000 points, s"] == 50.0
    assert pca["exponent"] == pytest.approx(1.0)
    growth.draw(config, rows, tmp_path / "growth.png")
    assert (tmp_path / "growth.pdf").read_bytes().startswith(b"%PDF")


def test_a_method_that_fails_by_an_error_is_run_on_the_next_size(monkeypatch):
    monkeypatch.setattr(
        Stub, "attempt", lambda self, task, limits: Result("", {}, "error", {}, "ValueError()", 0.0, "")
    )
    monkeypatch.setattr(growth, "Worker", Stub)
    rows = growth.run(growth.Config(sizes="300,600", repeats=1, methods="pca"))
    assert [(row["points"], row["failure"]) for row in rows] == [(300, "ValueError()"), (600, "ValueError()")]
    assert growth.summary(rows)[0]["600 points, s"] == "ValueError()"


def test_a_timed_call_has_the_angle_to_the_true_plane():
    row = growth.timed("3dsymm-all", "quadruped", 800, 0)
    assert row["seconds"] > 0
    assert row["angle"] < 5.0
