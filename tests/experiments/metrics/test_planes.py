"""GTE, the F-score of E3Sym, and the scores of SHREC 2023."""

import numpy as np
import pytest

from experiments.data.cases import generate_case
from experiments.metrics import e3sym, funk, hits, shrec
from experiments.metrics.deviation import deviation
from experiments.metrics.gte import gte
from experiments.metrics.matching import Tally
from experiments.metrics.prediction import Prediction
from symjax.errors import InvalidArgumentError
from symjax.geometry.directions import deviation_angle
from symjax.geometry.plane import Plane
from tests.experiments.metrics.cubes import AXES, moved, prediction, ranking, tilted


def test_gte_is_given_with_and_without_square_and_ignores_the_sign_of_the_normal():
    one = prediction([Plane(-tilted(4.0).normal, np.asarray(-0.05))], (tilted(0.0), tilted(90.0)))
    chord = (2 * np.sin(np.radians(2.0))) ** 2
    assert gte(one).squared == pytest.approx(chord + 0.05**2 / 3, rel=1e-12)
    assert gte(one).plain ** 2 == pytest.approx(gte(one).squared)
    with pytest.raises(InvalidArgumentError, match="there are 0 and 1"):
        gte(prediction([]))


def test_e3sym_averages_over_thresholds():
    assert e3sym.f_score([prediction([tilted(0.0), tilted(90.0)], (tilted(0.0), tilted(90.0)))]) == pytest.approx(
        200 / 201
    )
    # D = 0.1: no match at the first 100 of 201 thresholds
    one = prediction([Plane(AXES[0], np.asarray(0.1 * np.sqrt(3) - 1e-9))])
    assert e3sym.f_score([one]) == pytest.approx(101 / 201)
    assert e3sym.f_score([one], e3sym.COARSE) == pytest.approx(3 / 4)


def test_e3sym_matches_one_to_one_and_pools():
    twice = prediction([tilted(0.0), tilted(0.1)])
    assert e3sym.tallies([twice, prediction([])], np.array([0.2])) == [Tally(1, 2, 2)]
    assert e3sym.f_score([]) == 0.0


def test_shrec_requires_one_degree_and_one_percent():
    assert shrec.hits(prediction([tilted(0.99)])).tolist() == [True]
    assert shrec.hits(prediction([tilted(1.01)])).tolist() == [False]
    assert shrec.hits(prediction([tilted(0.0, 0.0099 * np.sqrt(3))])).tolist() == [True]
    assert shrec.hits(prediction([tilted(0.0, 0.0101 * np.sqrt(3))])).tolist() == [False]


def test_shrec_scores_by_hand():
    truths = (tilted(0.0), tilted(90.0))
    # a miss, a hit, and the same true plane again
    late = prediction([tilted(45.0), tilted(0.0), tilted(0.1)], truths)
    assert shrec.hits(late).tolist() == [False, True, False]
    found = shrec.scores([late, prediction([tilted(0.0), tilted(90.0)], truths), prediction([], truths)])
    assert found == pytest.approx((1 / 3, (0.5 + 1 + 0) / 3, (0.25 + 1 + 0) / 3))


def test_scores_do_not_depend_on_pose_and_units(rng):
    one = prediction([tilted(2.0, 0.02), tilted(91.0)], (tilted(0.0), tilted(90.0)))
    other = moved(one, rng)
    assert gte(other) == pytest.approx(gte(one))
    assert e3sym.f_score([other]) == e3sym.f_score([one])
    assert shrec.scores([other]) == pytest.approx(shrec.scores([one]))
    assert deviation(other.ranking.plane(), other.case) == pytest.approx(deviation(one.ranking.plane(), one.case))
    assert funk.tally([funk.as_in_the_paper(other)], 3.0, 0.1).f == 1.0


def test_the_true_plane_of_a_generated_object_has_perfect_scores():
    case = generate_case("chair", 300, 0)
    one = Prediction(ranking(*case.planes), case)
    assert hits.area([deviation(one.ranking.plane(), case)]) > 1 - 1e-9
    assert gte(one).plain < 1e-12
    assert shrec.scores([one]) == (1.0, 1.0, 1.0)
    assert funk.tally([funk.compared(one)], 0.1, 0.01).f == 1.0
    assert deviation_angle(one.answers[0][0], one.truths[0][0]) == 0.0
    np.testing.assert_allclose(
        one.to_diagonals.points(case.points), (case.points - case.points.mean(0)) / case.diagonal
    )
