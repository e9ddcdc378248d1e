"""Calibration of the robust method: the rule on the numbers in the rows is the rule of the method."""

from dataclasses import fields, replace

import numpy as np
import pytest

from experiments.studies.robust import calibration
from symjax.robust.classification import FoundThresholds
from symjax.robust.method import Robust


@pytest.fixture(scope="module")
def rows():
    config = replace(calibration.SIZES["small"], num_points=800, kinds=1, data="absent", conditions="clean,noise1")
    return calibration.run(config)


def test_every_threshold_is_varied_about_the_methods():
    assert {name for grid in calibration.GRIDS for name in grid} == {field.name for field in fields(FoundThresholds)}
    assert all(0.0 in steps for grid in calibration.GRIDS for steps in grid.values())


@pytest.mark.slow
def test_the_methods_own_thresholds_give_the_answers_of_the_method(rows):
    thresholds = Robust().found
    found = calibration.would_be_found(rows, thresholds)
    np.testing.assert_array_equal(found, [row["found"] for row in rows])
    assert {bool(at) for at in found} == {True, False}
    numbers = [[row[name] for name in ("exactness", "background", "noise")] for row in rows]
    expected = [thresholds.threshold(*one) for one in numbers]
    np.testing.assert_allclose([row["threshold"] for row in rows], expected, rtol=1e-9)


@pytest.mark.slow
def test_higher_thresholds_find_less(rows):
    thresholds = Robust().found
    for change in ({"base": 0.6}, {"most": 0.9, "per_background": 1.0}, {"exactness": 1.0}):
        higher = calibration.would_be_found(rows, replace(thresholds, **change))
        assert not (higher & ~calibration.would_be_found(rows, thresholds)).any()
    assert not calibration.would_be_found(rows, FoundThresholds(base=2.0, most=2.0, exact=2.0)).any()


@pytest.mark.slow
def test_noise_is_more_on_noisy_clouds(rows):
    noise = {(row["condition"], row["model"]): row["noise"] for row in rows}
    models = {model for _, model in noise}
    assert np.mean([noise["noise1", model] > noise["clean", model] for model in models]) == 1


@pytest.mark.slow
def test_the_summary_has_a_line_for_every_condition_target_and_choice(rows):
    lines = calibration.summary(rows)
    choices = sum(int(np.prod([len(steps) for steps in grid.values()])) for grid in calibration.GRIDS)
    named = [line["what"] for line in lines]
    assert named[:4] == ["clean", "noise1", "all, generated", "TARGET"]
    assert len(lines) == 4 + choices + 1
    assert (named[-1], lines[-1]["clouds"]) == ("clouds decided otherwise by the rule here", 0)
    same = [line for line in lines if line["what"] == "base 0.36, per_background 0.63"]
    assert [line["found: symmetric"] for line in same] == [lines[2]["found: symmetric"]]
