"""Ablation of the robust method: one option per stage, and shares of correct answers."""

from dataclasses import fields, replace

import pytest

from experiments.studies.robust import ablation
from symjax.robust.method import Robust


@pytest.mark.parametrize("stage", ablation.STAGES)
def test_every_stage_is_removed_by_one_option_that_differs_from_the_default(stage):
    method, whole = ablation.without(stage).method, Robust()
    changed = [field.name for field in fields(Robust) if getattr(method, field.name) != getattr(whole, field.name)]
    assert changed == list(ablation.STAGES[stage])
    assert len(changed) == (0 if stage in ("nothing", ablation.OUTLIER_RULE) else 1)


def test_the_whole_method_is_the_default():
    assert ablation.without("nothing").method == Robust()
    with pytest.raises(KeyError):
        ablation.without("magic")


def test_the_outlier_rule_is_removed_from_the_preparation():
    assert [stage for stage in ablation.STAGES if ablation.without(stage).drop_outliers is False] == ["outlier rule"]
    assert ablation.without("outlier rule").method == Robust()


def test_every_stage_has_a_row_for_every_cloud():
    config = replace(ablation.SIZES["small"], num_points=400, kinds=2, conditions="both", stages="nothing,refinement")
    rows = ablation.run(config)
    assert [row["without"] for row in rows] == ["nothing"] * 2 + ["refinement"] * 2
    assert [row["model"] for row in rows[:2]] == [row["model"] for row in rows[2:]]
    assert all(0 <= row["angle"] <= 90 and isinstance(row["correct"], bool) for row in rows)


def row_of(stage, condition, correct, correct_plane):
    return {"without": stage, "condition": condition, "correct": correct, "correct plane": correct_plane}


def test_the_summary_has_shares_by_stage_and_condition():
    rows = [row_of("nothing", "both", True, True), row_of("nothing", "view", False, True)]
    rows += [row_of("refinement", "both", False, False), row_of("refinement", "view", False, True)]
    lines = ablation.summary(rows)
    assert [(line["without"], line["share of"], line["all"]) for line in lines] == [
        ("nothing", "correct answers", 0.5),
        ("refinement", "correct answers", 0.0),
        ("nothing", "correct planes", 1.0),
        ("refinement", "correct planes", 0.5),
    ]
    assert [line["view"] for line in lines] == [0, 0, 1, 1]
