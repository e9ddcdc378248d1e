"""The robust method from points to plane: corruptions, equivariance, arguments, and degenerate clouds."""

from functools import cache

import numpy as np
import pytest

import symjax
from symjax.datasets import add_outliers, corrupt, generate, pose
from symjax.datasets.sample import random_orthogonal
from symjax.errors import InvalidArgumentError, InvalidPointsError, NonfiniteError
from symjax.geometry.distance import offset_error
from symjax.geometry.plane import Plane
from symjax.robust import search
from symjax.robust.method import Robust
from symjax.robust.surface import estimate_surface

NUM = 1_500
CORRUPTIONS = {
    "clean": {},
    "outliers": {"outliers": 1.0},
    "missing": {"missing": 0.28},
    "both": {"outliers": 1.0, "missing": 0.28},
    "noise": {"noise": 0.01},
}


@cache
def sample_of(kind, seed):
    return pose(generate(kind, num_points=NUM, rng=seed), seed + 1)


@pytest.fixture(scope="module")
def cloud():
    return sample_of("quadruped", 0).points


@pytest.fixture(scope="module")
def truth():
    normal, offset = sample_of("quadruped", 0).planes[0]
    return Plane(normal, np.float64(offset))


@pytest.fixture(scope="module")
def detection(cloud):
    return symjax.detect(cloud)


def offset_between(plane, other, detection):
    return offset_error(plane, other, detection.points.mean(axis=0), detection.diagonal)


@pytest.mark.parametrize("corruption", CORRUPTIONS)
@pytest.mark.parametrize(("kind", "seed"), [("quadruped", 1), ("human", 0), ("aeroplane", 1)])
def test_the_true_plane_is_found_under_every_corruption(kind, seed, corruption):
    sample = sample_of(kind, seed)
    found = symjax.detect(corrupt(sample.points, seed, **CORRUPTIONS[corruption]).points)
    planted = Plane(*sample.planes[0])
    assert found.plane.angle(planted) < (1 if corruption in ("clean", "outliers") else 3)
    assert offset_error(found.plane, planted, sample.points.mean(axis=0), sample.diagonal) < 0.02
    assert found.found
    assert found.score > found.threshold


def test_the_plane_of_a_clean_cloud_is_exact_to_a_tenth_of_a_degree_and_within_its_standard_errors(detection, truth):
    assert detection.plane.angle(truth) < 0.1
    assert detection.uncertainty.distance(detection.plane, truth) < 5
    assert not detection.uncertainty.contains(detection.plane, Plane(truth.normal, truth.offset + 0.1))
    np.testing.assert_allclose(detection.uncertainty.tangents @ detection.plane.normal, 0, atol=1e-9)
    assert detection.uncertainty.offset < 0.01 * detection.diagonal


def test_a_seed_reproduces_every_bit_and_another_seed_the_plane(cloud, detection):
    again, other = symjax.detect(cloud), symjax.detect(cloud, rng=7)
    np.testing.assert_array_equal(again.plane.normal, detection.plane.normal)
    assert (again.plane.offset, again.score, again.threshold) == (
        (detection.plane.offset, detection.score, detection.threshold)
    )
    np.testing.assert_array_equal(again.pairs.rows, detection.pairs.rows)
    np.testing.assert_array_equal(again.uncertainty.covariance, detection.uncertainty.covariance)
    assert other.plane.angle(detection.plane) < 0.1


@pytest.mark.parametrize("change", ["rotation", "reflection", "permutation", "shift", "small"])
def test_the_plane_moves_with_the_cloud(cloud, detection, rng, change):
    turn, shift, scale, order = np.eye(3), np.zeros(3), 1.0, np.arange(NUM)
    if change in ("rotation", "reflection"):
        turn = random_orthogonal(rng, reflect=change == "reflection")
    elif change == "permutation":
        order = rng.permutation(NUM)
    elif change == "shift":
        shift = np.array([1e6, -1e6, 1e6])
    else:
        scale = 1e-6
    moved = symjax.detect((scale * cloud @ turn.T + shift)[order])
    normal = turn @ detection.plane.normal
    assert moved.plane.angle(Plane(normal, np.float64(0.0))) < 0.1
    foot = scale * detection.plane.offset * normal + shift
    assert abs(moved.plane.signed_distance(foot[None])[0]) < 1e-3 * moved.diagonal
    assert moved.score == pytest.approx(detection.score, abs=0.02)
    assert moved.uncertainty.offset == pytest.approx(scale * detection.uncertainty.offset, rel=0.2)


def test_pairs_are_given_points_that_the_plane_reflects_onto_each_other(cloud, detection):
    pairs = detection.pairs
    np.testing.assert_array_equal(pairs.x, cloud[pairs.rows[:, 0]])
    np.testing.assert_array_equal(pairs.y, cloud[pairs.rows[:, 1]])
    assert len(np.unique(pairs.rows[:, 0])) == len(pairs.rows) > 0.9 * NUM
    assert ((pairs.weight >= 0) & (pairs.weight <= 1)).all()
    off = np.linalg.norm(detection.mirror(pairs.x) - pairs.y, axis=1) / estimate_surface(cloud).spacing
    assert off[pairs.weight > 0.5].max() < 4
    assert np.median(off[pairs.weight > 0.5]) < 1
    assert 0 < detection.inlier_fraction <= 1
    assert detection.inlier_fraction == np.mean(detection.pairs.weight >= detection.inlier_weight)
    assert (pairs.weight > 0.5).mean() > 0.8


def test_candidates_are_distinct_and_the_first_is_the_plane(detection):
    assert 1 < len(detection.candidates) <= 9
    assert detection.candidates[0].plane is detection.plane
    for i, one in enumerate(detection.candidates):
        for other in detection.candidates[:i]:
            apart = offset_between(one.plane, other.plane, detection)
            assert one.plane.angle(other.plane) > 3 or apart > 0.01


def test_an_initial_plane_is_found_although_no_hypothesis_is_near_it(cloud, truth, monkeypatch):
    nowhere = Plane(np.tile([[0.0, 0.0, 1.0]], (8, 1)), np.linspace(2, 3, 8))
    monkeypatch.setattr(search, "hypotheses", lambda *_, **__: nowhere)
    turned = truth.normal + 0.08 * np.cross(truth.normal, [0.0, 0.0, 1.0])
    with_prior = symjax.detect(cloud, Robust(init=Plane(2 * turned, 2 * truth.offset)))
    assert with_prior.plane.angle(truth) < 0.5
    assert with_prior.found
    assert not symjax.detect(cloud).found


def test_a_wrong_initial_plane_is_harmless(cloud, detection):
    bad = Plane(np.array([0.6, 0.8, 0.0]), np.float64(40.0))
    assert symjax.detect(cloud, Robust(init=bad)).plane.angle(detection.plane) < 0.05


@pytest.mark.parametrize(
    ("normal", "offset"),
    [
        (np.zeros(3), np.float64(0)),
        (np.ones(2), np.float64(0)),
        (np.ones((2, 3)), np.zeros(2)),
        (np.array([1.0, np.nan, 0.0]), np.float64(0)),
        (np.ones(3), np.float64("inf")),
    ],
)
def test_a_malformed_initial_plane_is_rejected(normal, offset):
    with pytest.raises(InvalidArgumentError, match="init"):
        Robust(init=Plane(normal, offset))


@pytest.mark.parametrize("init", ["plane", 5, ([1.0, 0.0, 0.0],), (np.ones(3), "a")])
def test_an_initial_plane_of_another_type_is_rejected(init):
    with pytest.raises(InvalidArgumentError, match="init"):
        Robust(init=init)


def test_max_planes_limits_the_candidates(cloud, detection):
    one = symjax.detect(cloud, max_planes=1)
    assert len(one.candidates) == 1
    assert one.plane.angle(detection.plane) < 0.05


def test_given_normals_give_the_same_plane_as_estimated_ones(cloud, detection):
    normals = estimate_surface(cloud).normals
    given = symjax.detect(cloud, normals=-3 * normals)
    assert given.plane.angle(detection.plane) < 0.2
    assert given.score == pytest.approx(detection.score, abs=0.01)
    with pytest.raises(InvalidPointsError, match="1 normals"):
        symjax.detect(cloud, normals=np.r_[np.zeros((1, 3)), normals[1:]])
    with pytest.raises(InvalidPointsError, match="shape"):
        symjax.detect(cloud, normals=normals[1:])


@pytest.mark.parametrize("kind", ["ball", "chair", "quadruped"])
def test_fifty_points_are_enough(kind):
    found = symjax.detect(generate(kind, num_points=50, rng=0).points)
    assert found.num_used == 50
    assert np.isfinite([*found.plane.normal, found.plane.offset, found.score]).all()


def test_the_planes_of_a_flat_cloud_are_perpendicular_to_it(rng):
    outline = rng.uniform(-1, 1, size=(3_000, 2))
    wide = np.abs(outline[:, 0]) < 0.2 + 0.25 * (1 + outline[:, 1]) ** 2 * (outline[:, 1] < 0.7)
    found = symjax.detect(np.c_[outline[wide], np.zeros(wide.sum())])
    assert max(abs(candidate.plane.normal[2]) for candidate in found.candidates) < 1e-6
    assert found.plane.angle(Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))) < 5
    assert any("coplanar" in note for note in found.notes)


def test_a_large_cloud_is_thinned_and_a_note_says_so():
    found = symjax.detect(generate("quadruped", num_points=40_000, rng=0).points, max_points=2_000)
    assert (found.num_points, found.num_used <= 2_000) == (40_000, True)
    assert any("thinned from 40000" in note for note in found.notes)
    assert found.plane.angle(Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))) < 0.5


def test_nan_is_rejected_or_dropped(cloud, detection):
    holed = np.vstack([np.full((10, 3), np.nan), cloud])
    with pytest.raises(NonfiniteError, match="10 of"):
        symjax.detect(holed)
    found = symjax.detect(holed, nonfinite="drop")
    assert found.plane.angle(detection.plane) < 0.01
    np.testing.assert_array_equal(found.pairs.x, holed[found.pairs.rows[:, 0]])


def test_outliers_are_dropped_unless_drop_outliers_is_false(cloud):
    points = add_outliers(cloud, 0.3, 1)
    dropped, kept = symjax.detect(points), symjax.detect(points, drop_outliers=False)
    assert kept.num_used == len(points) > dropped.num_used
    assert any("outliers" in note for note in dropped.notes)
    assert not any("outliers" in note for note in kept.notes)


def test_sym_hks_finds_the_plane_among_outliers_if_they_are_dropped_first(cloud, truth):
    found = symjax.detect(add_outliers(cloud, 0.6, 1), "sym-hks", drop_outliers=True)
    assert found.plane.angle(truth) < 3
    assert found.found
