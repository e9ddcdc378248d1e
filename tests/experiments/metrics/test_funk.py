"""Precision and recall at Funk's thresholds, and over the scores."""

import numpy as np
import pytest

from experiments.metrics import funk, patch, score_curve
from experiments.metrics.matching import Tally
from tests.experiments.metrics.cubes import prediction, tilted


def test_funk_matches_several_planes_one_to_one():
    truths = (tilted(0.0), tilted(90.0))
    shapes = [funk.compared(prediction([tilted(1.0), tilted(2.0), tilted(91.0)], truths))]
    assert funk.tally(shapes, 5.0, 0.5) == Tally(2, 3, 2)
    assert funk.tally(shapes, 1.5, 0.5) == Tally(2, 3, 2)
    assert funk.tally(shapes, 0.5, 0.5) == Tally(0, 3, 2)


def test_the_distance_is_in_units_of_the_shorter_side():
    shapes = [funk.compared(prediction([tilted(0.0, 0.3)]))]
    assert funk.tally(shapes, 5.0, 0.31) == Tally(1, 1, 1)
    assert funk.tally(shapes, 5.0, 0.29) == Tally(0, 1, 1)


def test_published_rectangles_of_the_true_planes_are_used():
    corners = np.array([[[0, -0.2, -0.2], [0, -0.2, 0.2], [0, 0.2, -0.2]]])
    shape = funk.compared(prediction([tilted(0.0, 0.3)]), patch.from_corners(corners))
    assert funk.tally([shape], 5.0, 0.76).hits == 1
    assert funk.tally([shape], 5.0, 0.74).hits == 0


def test_the_papers_protocol_gives_the_share_within_the_angle_at_any_distance(rng):
    angles = rng.uniform(0, 60, 40)
    # the offset of 5 and the second predicted plane must not matter
    all_answered = [prediction([tilted(a, 5.0), tilted(0.0)], (tilted(0.0), tilted(90.0))) for a in angles]
    shapes = [funk.as_in_the_paper(one) for one in all_answered]
    nearest = np.minimum(angles, 90 - angles)
    for degrees in (1.0, 5.0, 20.0, 45.0):
        tally = funk.tally(shapes, degrees, 1e-9)
        assert tally.precision == tally.recall == tally.f == (nearest < degrees).mean()
    assert funk.tally([funk.as_in_the_paper(prediction([]))], 5.0, 1.0) == Tally(0, 0, 1)


def test_the_curve_rises_from_no_match_to_all():
    shapes = [funk.compared(prediction([tilted(a)])) for a in (0.0, 3.0, 12.0)]
    curve = funk.curve(shapes)
    assert [tally.hits for tally in curve] == sorted(tally.hits for tally in curve)
    assert (curve[0].f, curve[-1].f) == (0.0, 1.0)


def test_the_curve_over_the_scores_counts_ties_together():
    good, bad = prediction([tilted(0.0)]), prediction([tilted(30.0)])
    curve = score_curve.curve([good, bad, prediction([])])
    assert (curve.scores.tolist(), curve.precision.tolist()) == ([1.0], [0.5])
    assert curve.recall == pytest.approx([1 / 3])
    sure = good._replace(ranking=good.ranking._replace(scores=np.array([2.0])))
    assert score_curve.curve([bad, sure]).precision.tolist() == [1.0, 0.5]
    assert score_curve.curve([prediction([])]).scores.size == 0
