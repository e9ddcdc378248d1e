"""All results of the golden file are reproduced, up to changes that rounding errors of nearest neighbours can cause."""

import json

import numpy as np
import pytest

from symjax.datasets import KINDS
from symjax.geometry.directions import deviation_angle
from tests.golden.cases import DETECTIONS, FILE, FITS, detection, fit, name_of

GOLDEN = json.loads(FILE.read_text(encoding="utf-8"))

RIGHT = {"single": "one plane", "multiple": "several planes", "none": "none"}
"""The correct result by the symmetry of the kind. For a continuous symmetry, any plane through the axis is correct."""

QUICK = {name_of(case) for case in [*DETECTIONS[0:300:13], *DETECTIONS[300:360:12], *FITS[::3]]}
"""The cases that run by default; all others are slow tests."""


def marked(cases):
    return [
        pytest.param(case, id=name_of(case), marks=() if name_of(case) in QUICK else pytest.mark.slow) for case in cases
    ]


def test_at_least_forty_cases_run_by_default():
    assert len(QUICK) >= 40
    assert len(GOLDEN["detections"]) == 360
    assert len(GOLDEN["fits"]) == 40


def assert_same_planes(then, now):
    """Checks that every mirror plane is found again, in any order, to the accuracy of a refinement."""
    assert len(now["planes"]) == len(then["planes"])
    for *normal, offset in then["planes"]:
        apart = [
            (float(deviation_angle(np.array(normal), np.array(n))), abs(np.sign(np.dot(normal, n)) * w - offset))
            for *n, w in now["planes"]
        ]
        angle, shift = min(apart)
        assert angle <= max(1e-3, 0.5 * then["normal_error"])
        assert shift <= max(1e-5 * then["diagonal"], 0.5 * then["offset_error"])


@pytest.mark.filterwarnings("ignore::symjax.errors.SymjaxWarning")
@pytest.mark.parametrize("case", marked(DETECTIONS))
def test_a_detection_is_the_same(case):
    then, now = GOLDEN["detections"][name_of(case)], detection(*case)
    assert now["score"] == pytest.approx(then["score"], abs=1e-3)
    assert now["threshold"] == pytest.approx(then["threshold"], abs=1e-3)
    if abs(then["score"] - then["threshold"]) > 0.01:
        assert now["found"] == then["found"]
        # a plane that the object does not have is a local optimum, and rounding errors decide which one is found
        if then["symmetry"] == RIGHT.get(KINDS[case[0]].symmetry):
            assert now["symmetry"] == then["symmetry"]
            assert now["ambiguous"] == then["ambiguous"]
            assert_same_planes(then, now)
    # if several planes are equally good, any of them may be first
    if not then["ambiguous"] and then["margin"] > 0.01:
        angle = float(deviation_angle(np.array(now["normal"]), np.array(then["normal"])))
        sign = np.sign(np.dot(now["normal"], then["normal"]))
        assert angle <= max(1e-4, 0.1 * then["normal_error"])
        apart = abs(sign * now["offset"] - then["offset"])
        assert apart <= max(1e-6 * then["diagonal"], 0.1 * then["offset_error"])


@pytest.mark.parametrize("case", marked(FITS))
def test_a_fit_is_the_same(case):
    then, now = GOLDEN["fits"][name_of(case)], fit(*case)
    assert now["converged"] == then["converged"]
    np.testing.assert_allclose(now["loss"], then["loss"], rtol=1e-6)
    assert np.max(deviation_angle(np.array(now["normal"]), np.array(then["normal"]))) < 1e-4
    np.testing.assert_allclose(now["offset"], then["offset"], atol=1e-6)
