"""The task of the comparison: one method on one corrupted cloud."""

import json

import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")


from experiments.baselines import registry
from experiments.baselines.pca import PCA
from experiments.baselines.registry import ENTRIES
from experiments.comparison import evaluate
from experiments.data import procedural


def test_a_row_is_json_and_depends_on_the_task_only():
    arguments = ("cicconet", "procedural", 1, procedural.kind(1), "out40", 0, 300)
    first, second = evaluate.evaluate(*arguments), evaluate.evaluate(*arguments)
    assert first.pop("seconds") > 0
    second.pop("seconds")
    assert json.loads(json.dumps(first, allow_nan=False)) == second
    assert first["gte_squared"] == pytest.approx(first["gte"] ** 2)
    assert first["funk_paper"][-1] == (first["angle"] < 45)


def test_an_exception_counts_as_no_answer(monkeypatch):
    class Failing(PCA):
        def rank(self, points, rng):
            raise ValueError("no plane")

    monkeypatch.setitem(ENTRIES, "pca", registry.baseline_entry("PCA", Failing()))
    row = evaluate.evaluate("pca", "procedural", 0, procedural.kind(0), "clean", 0, 200)
    assert (row["angle"], row["planes"], row["raised"]) == (90.0, [], "ValueError('no plane')")
    assert len(row["truths"]) >= 1


def test_an_object_with_an_unexpected_name_is_refused():
    with pytest.raises(ValueError, match="is 'sofa', not 'chair'"):
        evaluate.evaluate("pca", "procedural", 1, "chair", "clean", 0, 200)
