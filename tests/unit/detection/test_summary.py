"""The text summary of a detection has one label and value a line."""

import numpy as np
import pytest

from symjax.detection.summary import lines
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from tests.helpers.detections import blob, detection_of

AXIS = (np.array([1.0, 2.0, 3.0]), np.array([0.0, 0.0, 1.0]))


def summary(rng, **changes):
    return dict(line.split(maxsplit=1) for line in lines(detection_of(blob(rng, 30), **changes)))


def test_the_plane_the_score_and_the_scale_have_their_units(rng):
    shown = summary(rng, weights=(1.0,) * 4, timings={"preparing": 0.25, "fitting": 1.5}, notes=("a note",))
    assert shown["normal"] == "+0.600000  +0.000000  +0.800000"
    assert shown["offset"].startswith("+0.3 ")
    assert shown["found"] == "yes   (score 0.600, above the threshold of 0.300)"
    assert shown["symmetry"] == "one plane"
    assert shown["inliers"] == "75.0% of 4 pairs"
    assert shown["sigma"] == "0.02 of the diagonal, 0.04 in the units of the points"
    assert shown["points"] == "30 given, 30 used"
    assert shown["note"] == "a note"
    assert shown["seconds"] == "1.75   (preparing 0.25, fitting 1.50)"


def test_without_a_mirror_plane_no_symmetry_is_shown(rng):
    shown = summary(rng, found=False, score=0.2, symmetry="none", converged=False, message="")
    assert shown["found"] == "no   (score 0.200, not above the threshold of 0.300)"
    assert "symmetry" not in shown
    assert shown["solver"] == "not converged"


def test_what_a_method_does_not_compute_is_not_shown(rng):
    nothing = dict.fromkeys(["threshold", "exactness", "inlier_fraction", "sigma", "uncertainty"])
    shown = summary(rng, **nothing)
    assert shown["found"] == "yes   (score 0.600)"
    assert not {"exactness", "inliers", "sigma", "precision"} & shown.keys()


def test_standard_errors_are_in_degrees_and_units(rng):
    uncertainty = Uncertainty(np.diag([0.01, 0.0, 0.09]) ** 2, np.eye(3)[:2], np.zeros(3))
    shown = summary(rng, uncertainty=uncertainty, plane=Plane(np.array([0.0, 0.0, 1.0]), np.float64(0.0)))
    assert shown["precision"].startswith(f"normal {uncertainty.normal_degrees:.2g} degrees, offset 0.09 ")


@pytest.mark.parametrize(
    ("symmetry", "axis", "text"),
    [
        ("several planes", None, "several planes   (ambiguous: others are as good)"),
        ("sphere", AXIS, "all planes through a centre   (at +1.000000  +2.000000  +3.000000)"),
        ("axis", AXIS, "all planes through an axis   (through +1.000000  +2.000000  +3.000000 along +0.000000"),
    ],
)
def test_several_mirror_planes_are_listed(symmetry, axis, text, rng):
    planes = tuple(Plane(axis, np.float64(0.1)) for axis in np.eye(3))
    found = list(lines(detection_of(blob(rng, 30), ambiguous=True, symmetry=symmetry, axis=axis, planes=planes)))
    assert any(line.startswith("symmetry") and text in line for line in found)
    assert "plane 2   +0.000000  +1.000000  +0.000000   offset +0.1" in found
