"""The options of `Robust` are checked, and each of them changes its own stage only."""

from dataclasses import fields, replace

import numpy as np
import pytest

from symjax.datasets import corrupt, generate, pose
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import prepare
from symjax.robust import hypotheses, registration, search
from symjax.robust.method import Robust
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.scoring import score_plane
from symjax.robust.verification.thresholds import FoundThresholds
from symjax.robust.voxel_grid import voxel_grid
from tests.helpers.vessels import handle, vessel


@pytest.fixture(scope="module")
def cloud():
    sample = pose(generate("quadruped", num_points=1_500, rng=0), 1)
    return prepare(corrupt(sample.points, 0, missing=0.15).points)


def found(cloud, **changes):
    method = replace(Robust(), **changes)
    return method.find(cloud, max_planes=24, rng=np.random.default_rng(0), timer=StageTimer())


@pytest.fixture(scope="module")
def whole(cloud):
    return found(cloud)


@pytest.fixture(scope="module")
def surface(cloud):
    return estimate_surface(cloud.points)


@pytest.fixture(scope="module")
def grid(surface):
    return voxel_grid(surface, None, boundary_penalty=Robust().boundary_penalty)


def candidates(surface, grid, **changes):
    return search.candidates(surface, grid, np.random.default_rng(0), num_pairs=1024, **changes)


def test_a_method_is_a_frozen_dataclass_with_documented_options():
    assert Robust() == Robust()
    assert replace(Robust(), register=False) != Robust()
    with pytest.raises(AttributeError):
        Robust().refine = False
    assert Robust().found == FoundThresholds()
    assert all(f"{field.name}:" in Robust.__doc__ for field in fields(Robust))
    assert all(f"{field.name}:" in FoundThresholds.__doc__ for field in fields(FoundThresholds))


def test_methods_with_an_initial_plane_compare_and_hash():
    planes = [Plane(np.array([0.0, 0.0, length]), np.float64(length)) for length in (1.0, 2.0)]
    same, scaled = (Robust(init=plane) for plane in planes)
    other = Robust(init=Plane(np.array([0.0, 0.0, 1.0]), np.float64(2.0)))
    assert same == scaled
    assert hash(same) == hash(scaled)
    assert same != other
    assert same.init != other.init
    assert same != Robust()
    assert len({same, scaled, other, Robust()}) == 3
    np.testing.assert_array_equal(replace(same, register=False).init.normal, [0, 0, 1])


@pytest.mark.parametrize(
    "change",
    [
        {"boundary_penalty": -0.1},
        {"boundary_penalty": "a"},
        {"boundary_penalty": True},
        {"exactness_weight": None},
        {"max_refined": True},
        {"use_normals": "no"},
        {"refine": 1},
        {"boundary_penalty": 1.1},
        {"refine_above": float("nan")},
        {"chance_exactness": 2.0},
        {"inlier_agreement": -1.0},
        {"exactness_weight": float("inf")},
        {"exactness_weight": -0.1},
        {"num_pair_hypotheses": -1},
        {"num_pair_hypotheses": 2.5},
        {"max_refined": 0},
        {"found": 0.5},
    ],
)
def test_options_out_of_range_are_rejected(change):
    with pytest.raises(InvalidArgumentError, match=next(iter(change))):
        Robust(**change)


@pytest.mark.parametrize(
    "change", [{"base": -0.1}, {"most": float("nan")}, {"exact": "a"}, {"exactness_per_noise": float("inf")}]
)
def test_thresholds_out_of_range_are_rejected(change):
    with pytest.raises(InvalidArgumentError, match=next(iter(change))):
        FoundThresholds(**change)


def test_the_threshold_depends_on_background_exactness_and_noise():
    thresholds = FoundThresholds(
        base=0.3, per_background=0.5, most=0.6, exact=0.2, exactness=0.5, exactness_per_noise=1
    )
    assert thresholds.threshold(0.0, 0.0, 0.0) == pytest.approx(0.3)
    assert thresholds.threshold(0.5, 0.4, 0.0) == pytest.approx(0.5)
    assert thresholds.threshold(0.0, 0.9, 0.0) == pytest.approx(0.6)
    np.testing.assert_allclose(thresholds.threshold(np.array([0.55, 0.65]), np.zeros(2), 0.1), [0.3, 0.2])


def test_without_point_confidence_all_points_weigh_the_same(cloud):
    assert (estimate_surface(cloud.points, use_confidence=False).confidence == 1).all()
    assert estimate_surface(cloud.points).confidence.min() < 0.9


def test_without_pair_hypotheses_the_other_sources_remain(surface):
    some, none = (hypotheses.hypotheses(surface, np.random.default_rng(0), num_pairs=count) for count in (7, 0))
    assert len(some.offset) == len(none.offset) + 7
    np.testing.assert_array_equal(np.delete(some.normal, np.s_[3:10], axis=0), none.normal)


def test_without_registration_all_candidates_are_hypotheses(surface, grid):
    planes = hypotheses.hypotheses(surface, np.random.default_rng(0), num_pairs=1024)

    def apart(candidate):
        return np.min(
            np.abs(planes.normal - candidate.plane.normal).max(axis=1) + np.abs(planes.offset - candidate.plane.offset)
        )

    assert max(apart(candidate) for candidate in candidates(surface, grid, register=False)) == 0
    assert min(apart(candidate) for candidate in candidates(surface, grid)) > 1e-6


def test_without_exact_scoring_candidates_keep_the_scores_of_the_grid(surface, grid):
    exact, plain = candidates(surface, grid), candidates(surface, grid, exact_scoring=False)
    # the planes are the same, the scores are not
    assert {tuple(c.plane.normal) for c in exact} == {tuple(c.plane.normal) for c in plain}
    assert [c.score for c in plain] == sorted((c.score for c in plain), reverse=True)
    assert {c.score for c in exact}.isdisjoint(c.score for c in plain)


def test_without_normals_the_agreement_depends_on_the_place_only(surface, grid, whole):
    plane = whole.candidates[0].plane
    both, place = (score_plane(plane, surface, grid, use_normals=use) for use in (True, False))
    mirrored = surface.normals - 2 * np.outer(surface.normals @ plane.normal, plane.normal)
    cosine = (mirrored * surface.normals[place.partner]).sum(axis=1)
    np.testing.assert_allclose(place.agreement * cosine**2, both.agreement, rtol=1e-9, atol=1e-15)
    assert place.score > both.score


def test_without_normals_the_scores_of_the_grid_ignore_them(surface, grid, rng):
    shuffled = rng.permutation(surface.normals)
    rows = np.arange(256)
    planes = Plane(np.eye(3, dtype=np.float32), np.zeros(3, np.float32))
    ones = np.ones(256, np.float32)

    def scores(normals, use_normals):
        probes = registration.Probes(surface.points[rows].astype(np.float32), normals[rows].astype(np.float32), ones)
        return registration.grid_scores(planes, np.float32(0.05), probes, grid, use_normals=use_normals)

    np.testing.assert_array_equal(scores(shuffled, False), scores(surface.normals, False))
    assert np.abs(scores(shuffled, True) - scores(surface.normals, True)).max() > 0.1


def test_without_refinement_the_plane_is_that_of_the_search_but_has_standard_errors(surface, grid, cloud, whole):
    rough = found(cloud, refine=False)
    assert any(np.array_equal(rough.candidates[0].plane.normal, c.plane.normal) for c in candidates(surface, grid))
    assert not np.array_equal(rough.candidates[0].plane.normal, whole.candidates[0].plane.normal)
    np.testing.assert_array_equal(rough.uncertainty.covariance, whole.uncertainty.covariance)
    assert (rough.sigma, rough.converged) == (whole.sigma, whole.converged)


def test_without_exactness_candidates_are_ranked_by_their_scores(cloud, whole):
    plain = found(cloud, use_exactness=False)
    assert {c.exactness for c in plain.candidates} == {None}
    assert all(c.ranking_score == c.score for c in plain.candidates)
    assert whole.candidates[0].ranking_score > whole.candidates[0].score


def test_the_ranking_score_counts_exactness_above_chance(cloud):
    method = Robust(exactness_weight=0.7, chance_exactness=0.2)
    best = found(cloud, exactness_weight=0.7, chance_exactness=0.2).candidates[0]
    assert best.ranking_score == pytest.approx(best.score + 0.7 * max(best.exactness - 0.2, 0))
    assert method.chance_exactness == 0.2


def test_max_refined_limits_the_refined_candidates(cloud):
    assert [c.exactness is None for c in found(cloud, max_refined=1).candidates[:2]] == [False, True]
    many = found(cloud, max_refined=3, refine_above=0.0).candidates
    assert sum(c.exactness is not None for c in many) == 3


def test_boundary_penalty_is_the_penalty_at_the_boundary(surface, cloud):
    penalties = np.unique(voxel_grid(surface, None, boundary_penalty=0.6).penalty)
    np.testing.assert_array_equal(penalties, np.float32([0.6, 1.0]))
    neutral, counted = (found(cloud, boundary_penalty=penalty).candidates[0].score for penalty in (0.15, 1.0))
    assert counted < neutral


def test_without_visibility_a_scan_from_one_side_is_not_recognised():
    points = generate("quadruped", num_points=3_000, rng=0).points
    scan = prepare(corrupt(points, 0, one_sided=True).points)
    assert any("one side" in note for note in found(scan).notes)
    assert not any("one side" in note for note in found(scan, use_visibility=False).notes)


def tapered(points):
    """Narrows an object towards the bottom, so that the plane across its axis is no mirror plane."""
    return points * np.column_stack([1 + 0.3 * points[:, 2], 1 + 0.3 * points[:, 2], np.ones(len(points))])


def test_without_contradiction_planes_are_found_that_the_handles_of_a_vessel_refute(rng):
    parts = [vessel(2_400, rng), handle(300, rng), handle(300, rng, degrees=110, size=0.9)]
    scene = prepare(tapered(np.concatenate(parts)))
    strict, lenient = found(scene), found(scene, use_contradiction=False)
    assert strict.symmetry == "none"
    assert strict.candidates[0].score > strict.threshold
    assert any("no missing part explains that" in note for note in strict.notes)
    assert lenient.symmetry != "none"


def test_the_plane_through_the_handle_of_a_vessel_is_found(rng):
    scene = prepare(tapered(np.concatenate([vessel(2_700, rng), handle(300, rng)])))
    result = found(scene)
    assert (result.symmetry, len(result.planes)) == ("one plane", 1)
    assert scene.to_given.plane(result.planes[0]).angle(Plane(np.array([0.0, 1.0, 0.0]), np.float64(0))) < 2


def test_inliers_are_pairs_whose_agreement_reaches_inlier_agreement(cloud, whole):
    strict = found(cloud, inlier_agreement=0.99)
    np.testing.assert_array_equal(strict.weight, whole.weight)
    assert strict.inlier_weight == 0.99
    assert strict.inlier_fraction < whole.inlier_fraction


def test_the_thresholds_decide_what_is_found(cloud, whole):
    assert whole.symmetry == "one plane"
    none = found(cloud, found=FoundThresholds(base=2.0, most=2.0, exact=2.0))
    assert (none.symmetry, none.planes, none.threshold) == ("none", (), 2.0)
    np.testing.assert_array_equal(none.candidates[0].plane.normal, whole.candidates[0].plane.normal)
