"""Every score against what its definition gives by hand."""

import numpy as np
import pytest
from trimesh.triangles import closest_point

from experiments.baselines.ranking import Ranking
from experiments.data.cases import Case, made
from experiments.data.corruptions import Deviation
from experiments.metrics import e3sym, funk, hits, matching, patch, ranked, shrec
from experiments.metrics.answered import Answered
from experiments.metrics.deviation import deviation
from experiments.metrics.distance import squared_distances
from experiments.metrics.frame import AS_STORED, frame_of
from experiments.metrics.gte import gte
from experiments.metrics.sde import cloud_sde, mean_sde, sde
from experiments.metrics.tally import Tally, pooled
from symjax.errors import InvalidArgumentError
from symjax.geometry.directions import deviation_angle
from symjax.geometry.plane import Plane
from symjax.io.mesh import Mesh, sample

AXES = np.eye(3)
CUBE = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
BOX = Mesh(CUBE, np.array([f[:1] + f[i : i + 2] for f in FACES for i in (1, 2)]), 6)


def tilted(degrees, offset=0.0):
    """A plane whose normal is so far from x."""
    angle = np.radians(degrees)
    return Plane(np.array([np.cos(angle), np.sin(angle), 0.0]), np.asarray(offset))


def ranking(*planes):
    normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
    offsets = np.array([float(plane.offset) for plane in planes])
    return Ranking(normals, offsets, 1.0 - 0.1 * np.arange(len(planes)))


def cube(*truths, name="cube"):
    """The corners of a cube about the origin, and those of its planes that count as right."""
    return Case(name, "test", CUBE, truths or (tilted(0.0),), np.sqrt(3.0))


def answered(answers, truths=()):
    return Answered(ranking(*answers), cube(*truths))


def moved(one, rng):
    """The same answer to the same object elsewhere, in other units."""
    turn, shift, scale = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3), 7.0
    normals = one.ranking.normals @ turn.T
    posed = Ranking(normals, scale * one.ranking.offsets + normals @ shift, one.ranking.scores)
    planes = tuple(Plane(turn @ n, scale * w + turn @ n @ shift) for n, w in one.case.planes)
    points = scale * one.case.points @ turn.T + shift
    return Answered(posed, one.case._replace(points=points, planes=planes, diagonal=scale * one.case.diagonal))


def test_hit_rates_and_area_of_known_angles():
    deviations = [Deviation(angle, 0.0) for angle in (0.5, 1.5, 4.0, 9.0, 30.0, 60.0)]
    assert hits.hit_rates(deviations) == {1.0: 1 / 6, 2.0: 2 / 6, 5.0: 3 / 6, 10.0: 4 / 6, 45.0: 5 / 6}
    grid = np.linspace(0, 45, 200_001)
    steps = np.mean([grid > d.angle for d in deviations], axis=0)
    assert hits.area(deviations) == pytest.approx(np.trapezoid(steps, grid) / 45, abs=1e-5)
    assert hits.area(deviations) == pytest.approx(1 - 45 / (45 * 6) - 1 / 6, abs=1e-12)


def test_perfect_answers_hit_at_all_angles_and_have_area_one():
    assert set(hits.hit_rates([Deviation(0.0, 0.0)] * 3).values()) == {1.0}
    assert hits.area([Deviation(0.0, 0.0)] * 3) == 1.0


@pytest.mark.parametrize("miss", [Deviation(0.0, 0.02), Deviation(90.0, 1.0), Deviation(np.nan, np.nan)])
def test_an_offset_that_is_too_large_or_no_answer_is_a_miss(miss):
    assert set(hits.hit_rates([miss, Deviation(0.0, 0.019)]).values()) == {0.5}
    assert hits.area([miss, Deviation(0.0, 0.019)]) == 0.5


def test_rates_of_nothing_are_refused():
    with pytest.raises(InvalidArgumentError, match="at least one"):
        hits.area([])
    with pytest.raises(InvalidArgumentError, match="at least one"):
        shrec.scores([])
    with pytest.raises(InvalidArgumentError, match="no SDE above 0"):
        mean_sde([0.0])


def test_deviation_is_that_from_the_nearest_plane_and_the_true_offset():
    near = deviation(tilted(3.0, 0.1), cube(tilted(0.0), tilted(90.0)))
    assert near.angle == pytest.approx(3.0, abs=1e-9)
    assert near.offset == pytest.approx(0.1 / np.sqrt(3), abs=1e-9)


def test_every_plane_through_an_axis_is_right(rng):
    case = cube()._replace(planes=(), axis=(np.array([0.2, 0.0, 0.0]), np.array([0.0, 0.0, 2.0])))
    for degrees in rng.uniform(0, 180, 5):
        plane = tilted(degrees)
        through = plane._replace(offset=np.asarray(plane.normal @ case.axis[0]))
        assert deviation(through, case) == pytest.approx((0, 0), abs=1e-9)
    leaning = Plane(np.array([np.cos(0.1), 0.0, np.sin(0.1)]), np.asarray(0.0))
    assert deviation(leaning, case).angle == pytest.approx(np.degrees(0.1), abs=1e-9)
    assert deviation(Plane(AXES[2], np.asarray(0.0)), case).angle == pytest.approx(90.0)


def test_matching_by_rank_lets_the_better_answer_choose_first():
    cost = np.array([[1.0, 2.0], [0.0, 5.0], [0.0, np.inf]])
    assert matching.by_rank(cost).tolist() == [0, 1, -1]
    assert matching.by_rank(np.empty((2, 0))).tolist() == [-1, -1]


def test_matching_by_cost_takes_the_cheapest_pair_first():
    assert matching.by_cost(np.array([[1.0, 2.0], [0.0, 5.0]])).tolist() == [0.0, 2.0]
    assert matching.by_cost(np.empty((0, 3))).size == 0


def test_a_tally_pools_counts_and_not_rates():
    tally = pooled([Tally(1, 1, 1), Tally(1, 4, 3)])
    assert tally == Tally(2, 5, 4)
    assert (tally.precision, tally.recall) == (0.4, 0.5)
    assert tally.f == pytest.approx(2 * 0.4 * 0.5 / 0.9)
    assert pooled([]).f == 0.0


def test_corners_of_a_file_give_the_middle_of_the_rectangle():
    # a plane of the organisers' table: x = 0, first corner next to both others
    corners = np.array([[[0, -3.61376, -1.39425], [0, -3.61376, 1.39425], [0, 3.61376, -1.39425]]])
    rectangle = patch.from_corners(corners)
    assert np.abs(rectangle.normals) == pytest.approx(AXES[:1])
    assert rectangle.centres == pytest.approx(np.zeros((1, 3)))
    assert rectangle.sides == pytest.approx([2 * 1.39425])
    assert patch.from_corners(corners, as_printed=True).centres == pytest.approx(np.array([[0, 0, -1.39425]]))


@pytest.mark.parametrize("axis", range(3))
def test_a_rectangle_bounds_the_cloud_on_its_plane(axis):
    points = CUBE * [1.0, 2.0, 4.0] + [10.0, 20.0, 30.0]
    rectangle = patch.bounding((AXES[axis : axis + 1], np.array([0.25])), points)
    centre = np.where(AXES[axis] == 1, 0.25, [10.0, 20.0, 30.0])
    assert rectangle.centres[0] == pytest.approx(centre)
    assert rectangle.sides[0] == pytest.approx(min(np.delete([1.0, 2.0, 4.0], axis)))


def test_funk_counts_several_planes_one_to_one():
    truths = (tilted(0.0), tilted(90.0))
    shapes = [funk.compared(answered([tilted(1.0), tilted(2.0), tilted(91.0)], truths))]
    assert funk.tally(shapes, 5.0, 0.5) == Tally(2, 3, 2)
    assert funk.tally(shapes, 1.5, 0.5) == Tally(2, 3, 2)
    assert funk.tally(shapes, 0.5, 0.5) == Tally(0, 3, 2)


def test_funk_distance_is_in_shorter_sides():
    shapes = [funk.compared(answered([tilted(0.0, 0.3)]))]
    assert funk.tally(shapes, 5.0, 0.31) == Tally(1, 1, 1)
    assert funk.tally(shapes, 5.0, 0.29) == Tally(0, 1, 1)


def test_funk_takes_rectangles_of_a_file():
    corners = np.array([[[0, -0.2, -0.2], [0, -0.2, 0.2], [0, 0.2, -0.2]]])
    shape = funk.compared(answered([tilted(0.0, 0.3)]), patch.from_corners(corners))
    assert funk.tally([shape], 5.0, 0.76).hits == 1
    assert funk.tally([shape], 5.0, 0.74).hits == 0


def test_funk_as_in_the_paper_is_the_share_within_the_angle_and_its_distance_never_fails(rng):
    angles = rng.uniform(0, 60, 40)
    # far from the cloud, with more answers and truths than one: neither is seen
    all_answered = [answered([tilted(a, 5.0), tilted(0.0)], (tilted(0.0), tilted(90.0))) for a in angles]
    shapes = [funk.as_in_the_paper(one) for one in all_answered]
    nearest = np.minimum(angles, 90 - angles)
    for degrees in (1.0, 5.0, 20.0, 45.0):
        tally = funk.tally(shapes, degrees, 1e-9)
        assert tally.precision == tally.recall == tally.f == (nearest < degrees).mean()
    assert funk.tally([funk.as_in_the_paper(answered([]))], 5.0, 1.0) == Tally(0, 0, 1)


def test_the_curve_of_funk_rises_from_nothing_to_all():
    shapes = [funk.compared(answered([tilted(a)])) for a in (0.0, 3.0, 12.0)]
    curve = funk.curve(shapes)
    assert [tally.hits for tally in curve] == sorted(tally.hits for tally in curve)
    assert (curve[0].f, curve[-1].f) == (0.0, 1.0)


def test_the_curve_over_scores_counts_ties_together():
    good, bad = answered([tilted(0.0)]), answered([tilted(30.0)])
    curve = ranked.curve([good, bad, answered([])])
    assert (curve.scores.tolist(), curve.precision.tolist()) == ([1.0], [0.5])
    assert curve.recall == pytest.approx([1 / 3])
    sure = good._replace(ranking=good.ranking._replace(scores=np.array([2.0])))
    assert ranked.curve([bad, sure]).precision.tolist() == [1.0, 0.5]
    assert ranked.curve([answered([])]).scores.size == 0


def test_gte_is_squared_and_not_and_blind_to_signs():
    one = answered([Plane(-tilted(4.0).normal, np.asarray(-0.05))], (tilted(0.0), tilted(90.0)))
    chord = (2 * np.sin(np.radians(2.0))) ** 2
    assert gte(one, AS_STORED).squared == pytest.approx(chord + 0.05**2, rel=1e-12)
    assert gte(one).squared == pytest.approx(chord + 0.05**2 / 3, rel=1e-12)
    assert gte(one).plain ** 2 == pytest.approx(gte(one).squared)
    with pytest.raises(InvalidArgumentError, match="an answer and a truth"):
        gte(answered([]))


def test_e3sym_averages_over_thresholds():
    assert e3sym.f_score([answered([tilted(0.0), tilted(90.0)], (tilted(0.0), tilted(90.0)))]) == pytest.approx(
        200 / 201
    )
    # D = 0.1: no match at the first 100 of 201 thresholds
    one = answered([Plane(AXES[0], np.asarray(0.1 - 1e-9))])
    assert e3sym.f_score([one], frame=AS_STORED) == pytest.approx(101 / 201)
    assert e3sym.f_score([one], e3sym.COARSE, AS_STORED) == pytest.approx(3 / 4)


def test_e3sym_matches_one_to_one_and_pools():
    twice = answered([tilted(0.0), tilted(0.1)])
    assert e3sym.tallies([twice, answered([])], np.array([0.2])) == [Tally(1, 2, 2)]
    assert e3sym.f_score([]) == 0.0


def test_shrec_asks_for_one_degree_and_one_percent():
    assert shrec.hits(answered([tilted(0.99)])).tolist() == [True]
    assert shrec.hits(answered([tilted(1.01)])).tolist() == [False]
    assert shrec.hits(answered([tilted(0.0, 0.0099 * np.sqrt(3))])).tolist() == [True]
    assert shrec.hits(answered([tilted(0.0, 0.0101 * np.sqrt(3))])).tolist() == [False]


def test_shrec_scores_by_hand():
    truths = (tilted(0.0), tilted(90.0))
    late = answered([tilted(45.0), tilted(0.0), tilted(0.1)], truths)  # a miss, a hit, and the same truth again
    assert shrec.hits(late).tolist() == [False, True, False]
    found = shrec.scores([late, answered([tilted(0.0), tilted(90.0)], truths), answered([], truths)])
    assert found == pytest.approx((1 / 3, (0.5 + 1 + 0) / 3, (0.25 + 1 + 0) / 3))


def test_scores_do_not_depend_on_pose_and_units(rng):
    one = answered([tilted(2.0, 0.02), tilted(91.0)], (tilted(0.0), tilted(90.0)))
    other = moved(one, rng)
    assert gte(other) == pytest.approx(gte(one))
    assert e3sym.f_score([other]) == e3sym.f_score([one])
    assert shrec.scores([other]) == pytest.approx(shrec.scores([one]))
    assert deviation(other.ranking.plane(), other.case) == pytest.approx(deviation(one.ranking.plane(), one.case))
    assert funk.tally([funk.as_in_the_paper(other)], 3.0, 0.1).f == 1.0


def test_distance_from_a_cube_by_hand():
    points = np.array([[0.0, 0, 0], [2.0, 0, 0], [0.1, 0.2, 0.9], [1.5, 1.5, 1.5], [0.5, 1.5, 0.25]])
    assert squared_distances(points, BOX) == pytest.approx([0.25, 2.25, 0.16, 3.0, 1.0])


@pytest.mark.parametrize("spread", [0.0, 3.0])
def test_distance_is_that_of_the_nearest_of_all_triangles(rng, spread):
    size = np.exp(spread * rng.normal(size=(400, 1, 1)))
    corners = rng.normal(size=(400, 1, 3)) + 0.1 * size * rng.normal(size=(400, 3, 3))
    points = 1.5 * rng.normal(size=(150, 3))
    soup = Mesh(corners.reshape(-1, 3), np.arange(1200).reshape(-1, 3), 400)
    pairs = closest_point(np.tile(corners, (150, 1, 1)), np.repeat(points, 400, axis=0)).reshape(150, 400, 3)
    least = ((pairs - points[:, None]) ** 2).sum(axis=2).min(axis=1)
    np.testing.assert_allclose(squared_distances(points, soup), least, rtol=1e-12, atol=1e-14)


def test_triangles_without_area_are_left_out():
    flat = np.array([[0, 0, 1], [0, 1, 0], [3, 3, 3]])
    points = np.array([[2.0, 0.1, 0.3]])
    assert squared_distances(points, BOX._replace(triangles=np.vstack([BOX.triangles, flat]))) == pytest.approx([2.25])
    with pytest.raises(InvalidArgumentError, match="without any area"):
        squared_distances(points, BOX._replace(triangles=flat))


def test_sde_of_a_cube_is_none_on_its_planes_and_known_beside_them(rng):
    assert sde(tilted(0.0), BOX, rng) == pytest.approx(0.0, abs=1e-30)
    shifted = sde(tilted(0.0, 0.05), BOX, np.random.default_rng(3), num_samples=20_000)
    # images are shifted by 0.1: one end is 0.1 outside; the other is inside, nearer to the sides at its rim; of the
    # sides a tenth sticks out
    inside = 0.8**2 * 0.1**2 + 4 * (0.1**3 / 3 - 0.1**4 / 2)
    assert shifted == pytest.approx((0.1**2 / 6 + inside / 6 + 4 / 6 * 0.1 * 0.1**2 / 3) / 3, rel=0.02)


def test_sde_does_not_depend_on_units():
    small = sde(tilted(2.0, 0.01), BOX, np.random.default_rng(0))
    large = sde(tilted(2.0, 10.0), BOX._replace(vertices=1000 * CUBE), np.random.default_rng(0))
    assert large == pytest.approx(small, rel=1e-9)


def test_sde_of_a_cloud_is_near_that_of_its_surface(rng):
    points, dense = sample(BOX, 2000, rng), sample(BOX, 40_000, rng)
    assert abs(cloud_sde(tilted(0.0), points, dense, np.sqrt(3))) < 2e-6
    plane = tilted(3.0, 0.03)
    exact = sde(plane, BOX, rng, num_samples=5000)
    assert cloud_sde(plane, points, dense, np.sqrt(3)) == pytest.approx(exact, rel=0.1)


def test_the_mean_sde_leaves_out_zeros():
    assert mean_sde([0.0, 1.0, 3.0]) == 2.0


def test_the_true_plane_of_a_generated_object_scores_full_marks():
    case = made("chair", 300, 0)
    one = Answered(ranking(*case.planes), case)
    assert hits.area([deviation(one.ranking.plane(), case)]) > 1 - 1e-9
    assert gte(one).plain < 1e-12
    assert shrec.scores([one]) == (1.0, 1.0, 1.0)
    assert funk.tally([funk.compared(one)], 0.1, 0.01).f == 1.0
    assert deviation_angle(one.answers[0][0], one.truths[0][0]) == 0.0
    assert frame_of(case).length == case.diagonal
