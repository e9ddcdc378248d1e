"""How `detect` handles the results of methods, valid and invalid."""

from dataclasses import dataclass

import numpy as np
import pytest

import symjax
from symjax.errors import MethodError
from symjax.geometry.plane import Plane
from symjax.method.result import Candidate, MethodResult
from symjax.viz.scene import headline
from tests.helpers.detections import detection_of

AXES = tuple(Plane(axis, np.float64(0.0)) for axis in np.eye(3))
CANDIDATES = tuple(Candidate(plane, 1.0, 1.0) for plane in AXES)


@dataclass(frozen=True)
class FixedResult:
    """A method that returns a given result."""

    result: MethodResult
    name: str = "fixed"
    drops_outliers: bool = False

    def find(self, cloud, *, max_planes, rng, timer):
        return self.result


@pytest.fixture
def cloud(rng):
    return rng.normal(size=(100, 3))


def test_a_method_without_a_candidate_is_named_in_the_error(cloud):
    with pytest.raises(MethodError, match="'fixed' returned no candidates"):
        symjax.detect(cloud, FixedResult(MethodResult((), (), "none")))


@pytest.mark.parametrize("most", [1, 2, 9])
def test_no_more_candidates_and_planes_are_kept_than_asked_for(cloud, most):
    found = symjax.detect(cloud, FixedResult(MethodResult(CANDIDATES, AXES, "several planes")), max_planes=most)
    assert len(found.candidates) == len(found.planes) == min(most, 3)


def test_a_result_that_contradicts_itself_is_refused():
    with pytest.raises(MethodError, match="'none' contradicts ambiguous=True"):
        MethodResult(CANDIDATES, (), "none", ambiguous=True)
    with pytest.raises(MethodError, match="'plane' is unknown"):
        MethodResult(CANDIDATES, AXES[:1], "plane")
    # the cloud may confirm only one of several planes that are equally good
    assert MethodResult(CANDIDATES, AXES[:1], "one plane", ambiguous=True).ambiguous


def test_the_headline_of_any_drawable_is_written(rng):
    found = detection_of(rng.normal(size=(20, 3)), ambiguous=True, symmetry="one plane")
    assert headline(found)[1].endswith("; ambiguous: other planes are equally good")
