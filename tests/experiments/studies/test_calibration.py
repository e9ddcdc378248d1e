"""Calibration of the robust method: the rule on the numbers in the rows agrees with the method."""

from dataclasses import fields, replace

import numpy as np
import pytest

from experiments.studies.robust import calibration
from symjax.robust.method import Robust
from symjax.robust.verification.thresholds import FoundThresholds


@pytest.fixture(scope="module")
def rows():
    config = replace(calibration.SIZES["small"], num_points=800, kinds=1, data="absent", conditions="clean,noise1")
    return calibration.run(config)


def test_every_threshold_is_varied_about_that_of_the_method():
    assert {name for grid in calibration.GRIDS for name in grid} == {field.name for field in fields(FoundThresholds)}
    assert all(0.0 in steps for grid in calibration.GRIDS for steps in grid.values())


@pytest.mark.slow
def test_the_methods_own_thresholds_give_the_answers_of_the_method(rows):
    thresholds = Robust().found
    found = calibration.would_be_found(rows, thresholds)
    np.testing.assert_array_equal(found, [row["found"] for row in rows])
    assert set(found.tolist()) == {True, False}
    numbers = [[row[name] for name in ("exactness", "background", "noise")] for row in rows]
    expected = [thresholds.threshold(*one) for one in numbers]
    np.testing.assert_allclose([row["threshold"] for row in rows], expected, rtol=1e-9)


@pytest.mark.slow
def test_higher_thresholds_find_fewer_planes(rows):
    thresholds = Robust().found
    for change in ({"base": 0.6}, {"most": 0.9, "per_background": 1.0}, {"exactness": 1.0}):
        higher = calibration.would_be_found(rows, replace(thresholds, **change))
        assert not (higher & ~calibration.would_be_found(rows, thresholds)).any()
    assert not calibration.would_be_found(rows, FoundThresholds(base=2.0, most=2.0, exact=2.0)).any()


@pytest.mark.slow
def test_the_estimated_noise_is_larger_for_noisy_clouds(rows):
    noise = {(row["condition"], row["model"]): row["noise"] for row in rows}
    models = {model for _, model in noise}
    assert np.mean([noise["noise1", model] > noise["clean", model] for model in models]) == 1


@pytest.mark.slow
def test_the_summary_has_lines_for_all_conditions_targets_and_thresholds(rows):
    lines = calibration.summary(rows)
    choices = sum(int(np.prod([len(steps) for steps in grid.values()])) for grid in calibration.GRIDS)
    names = [line["clouds of"] for line in lines]
    assert names[:4] == ["clean", "noise1", "all, generated", "TARGET"]
    assert len(lines) == 4 + choices + 1
    assert (names[-1], lines[-1]["clouds"]) == (calibration.DISAGREEMENT, 0)
    same = [line for line in lines if line["clouds of"] == "base 0.36, per_background 0.63"]
    assert [line["found: symmetric"] for line in same] == [lines[2]["found: symmetric"]]
