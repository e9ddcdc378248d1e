"""The order of candidates, and the verdicts on them, from their contradictions."""

from functools import cache

import numpy as np
import pytest

from symjax.datasets import generate, remove_part
from symjax.geometry.plane import Plane
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.contradiction import NO_CONTRADICTION, Contradiction
from symjax.robust.verification.evidence import Evidence, best_first

HANDLE = Contradiction(0.1, 0.1, 0.0)
CUT = Contradiction(0.1, 0.0, 0.9)
AXES = tuple(Plane(axis, np.float64(0.0)) for axis in np.eye(3))
TILTED = Plane(np.array([0.6, 0.8, 0.0]), np.float64(0.0))


@cache
def cut_block():
    """The surface of a block whose mirror planes are AXES, without a part beside all of them."""
    points = remove_part(generate("block", num_points=3000, rng=0).points, 0.1, 3)[0]
    return estimate_surface(points / np.linalg.norm(np.ptp(points, axis=0)))


def evidence(*contradictions, complete=True, one_sided=False, planes=AXES):
    return Evidence(cut_block(), one_sided, complete, planes[: len(contradictions)], contradictions)


@pytest.mark.parametrize(
    ("scores", "contradictions", "expected"),
    [
        # by ranking score
        ((0.8, 0.9, 0.7), (NO_CONTRADICTION,) * 3, ([1, 0, 2], True)),
        # a refuted plane is last, whatever its score
        ((0.8, 0.9, 0.7), (CUT, HANDLE, CUT), ([0, 2, 1], False)),
        # a plane that maps the whole cloud onto itself comes before one that needs a missing part and is no better
        ((0.896, 0.9, 0.7), (NO_CONTRADICTION, CUT, CUT), ([0, 1, 2], True)),
        # but not before a better one
        ((0.8, 0.9, 0.7), (NO_CONTRADICTION, CUT, CUT), ([1, 0, 2], False)),
    ],
)
def test_candidates_are_ordered_by_refutation_completeness_and_score(scores, contradictions, expected):
    assert best_first(scores, contradictions, one_sided=False) == expected


def test_a_scan_from_one_side_is_refuted_by_more():
    doubtful = Contradiction(0.04, 0.04, 0.0)
    assert best_first((0.9, 0.8), (doubtful, NO_CONTRADICTION), one_sided=False)[0] == [1, 0]
    assert best_first((0.9, 0.8), (doubtful, NO_CONTRADICTION), one_sided=True)[0] == [0, 1]


def test_a_complete_cloud_rules_planes_out_unless_a_cut_may_explain_them():
    beside_handle = Contradiction(0.1, 0.0, 0.3)
    verdicts = evidence(NO_CONTRADICTION, beside_handle, CUT, planes=(*AXES[:2], TILTED)).verdicts(range(4))
    assert list(verdicts.values()) == ["confirmed", "ruled out", "unconfirmed", "unconfirmed"]
    assert evidence(NO_CONTRADICTION, NO_CONTRADICTION).verdicts([1]) == {1: "confirmed"}


def test_the_best_plane_is_refuted_too():
    assert evidence(HANDLE, HANDLE, complete=False).verdicts([0]) == {0: "refuted"}
    assert evidence(CUT, HANDLE, complete=False).verdicts([0]) == {0: "confirmed"}


def test_an_incomplete_cloud_confirms_the_planes_of_the_completed_one():
    assert evidence(CUT, CUT, complete=False).verdicts([1]) == {1: "confirmed"}
    assert evidence(CUT, CUT, complete=False, planes=(AXES[0], TILTED)).verdicts([1]) == {1: "unconfirmed"}
