"""Method "sym-hks": planted planes, equivariance, options, and input that has no plane."""

import dataclasses

import numpy as np
import optimistix
import pytest
from scipy.spatial import cKDTree

import symjax
from symjax.errors import (
    ComponentsWarning,
    DegenerateCloudError,
    InvalidArgumentError,
    InvalidPointsError,
    NonfiniteError,
    SymjaxError,
    TooFewPointsError,
)
from symjax.geometry.local_frames import local_frames
from symjax.geometry.plane import Plane
from symjax.symhks.method import SymHKS

NORMAL = np.array([1.0, 0.0, 0.0])


OF_DETECT = ("normals", "rng", "nonfinite", "max_points")


def detect(points, **options):
    """Detects by SymHKS; options that `detect` does not have go to the method."""
    own = {name: options.pop(name) for name in OF_DETECT if name in options}
    return symjax.detect(points, SymHKS(**options), **own)


def creature(rng, num_points=3_000):
    """A body with a head and two ears, whose only mirror plane is x = 0; no point has an exact mirror image."""
    parts = [((0, 0, 0), (0.5, 1.2, 0.6), 0.55), ((0, 1.3, 0.5), (0.4, 0.5, 0.4), 0.25)]
    parts += [((side * 0.45, 1.4, 0.95), (0.15, 0.2, 0.45), 0.1) for side in (-1, 1)]
    points = []
    for centre, radii, share in parts:
        on_sphere = rng.normal(size=(int(share * num_points), 3))
        on_sphere /= np.linalg.norm(on_sphere, axis=1, keepdims=True)
        points.append(np.array(centre) + np.array(radii) * on_sphere)
    return np.concatenate(points)


def rotation(rng):
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


@pytest.fixture(scope="module")
def cloud():
    return creature(np.random.default_rng(5))


@pytest.fixture(scope="module")
def detection(cloud):
    return detect(cloud)


def test_the_planted_plane_is_found(detection):
    assert detection.plane.angle(Plane(NORMAL, np.float64(0.0))) < 3.0
    assert abs(detection.plane.offset) < 0.01 * detection.diagonal
    assert detection.found
    assert detection.converged
    assert detection.score > detection.threshold
    assert detection.message.startswith("Converged")
    assert list(detection.timings) == ["preparing", "spectrum", "keypoints", "matching", "fitting"]


def test_the_evidence_is_consistent(detection, cloud):
    pairs = detection.pairs
    np.testing.assert_array_equal(pairs.x, cloud[pairs.rows[:, 0]])
    np.testing.assert_array_equal(pairs.y, cloud[pairs.rows[:, 1]])
    residual = np.linalg.norm(detection.mirror(pairs.x) - pairs.y, axis=1) / (detection.sigma * detection.diagonal)
    np.testing.assert_allclose(pairs.weight, np.exp(-0.5 * residual**2), atol=1e-9)
    assert pairs.weight.mean() == pytest.approx(detection.score)
    assert detection.inlier_fraction == np.mean(pairs.weight >= detection.inlier_weight)
    assert detection.inlier_fraction == pytest.approx((residual < 2.7955).mean())
    assert detection.candidates[0].plane is detection.plane
    scores = [candidate.score for candidate in detection.candidates]
    assert scores == sorted(scores, reverse=True)
    largest = np.argmax(np.abs(detection.plane.normal))
    assert detection.plane.normal[largest] > 0


def test_candidates_are_distinct(detection):
    for i, first in enumerate(detection.candidates):
        for second in detection.candidates[:i]:
            apart = first.plane.angle(second.plane)
            sign = np.sign(first.plane.normal @ second.plane.normal)
            shifted = abs(first.plane.offset - sign * second.plane.offset) / detection.diagonal
            assert apart >= 5.0 or shifted >= 0.02


@pytest.mark.parametrize("change", ["rotation", "reflection", "permutation", "shift", "small", "large", "far"])
def test_the_plane_moves_with_the_cloud(cloud, detection, change, rng):
    turn, shift, scale, order = np.eye(3), np.zeros(3), 1.0, np.arange(len(cloud))
    if change == "rotation":
        turn = rotation(rng)
        turn *= np.sign(np.linalg.det(turn))
    elif change == "reflection":
        turn = rotation(rng)
        turn *= -np.sign(np.linalg.det(turn))
    elif change == "permutation":
        order = rng.permutation(len(cloud))
    elif change == "shift":
        shift = rng.normal(size=3) * 1e6
    elif change == "far":
        shift = rng.normal(size=3) * 1e8
    else:
        scale = {"small": 1e-12, "large": 1e12}[change]
    moved = detect((scale * cloud @ turn.T + shift)[order])
    normal = turn @ detection.plane.normal
    assert moved.plane.angle(Plane(normal, np.float64(0.0))) < 0.1
    # a point of the plane, moved with the cloud: far from the origin the offset itself is ill-conditioned
    foot = scale * detection.plane.offset * normal + shift
    assert abs(moved.plane.signed_distance(foot[None])[0]) < 1e-3 * moved.diagonal


def test_repeated_runs_agree_bit_for_bit(cloud, detection):
    again = detect(cloud)
    np.testing.assert_array_equal(again.plane.normal, detection.plane.normal)
    assert (again.plane.offset, again.threshold) == (detection.plane.offset, detection.threshold)


@pytest.mark.parametrize("solver", ["alternating", optimistix.BFGS(rtol=1e-8, atol=1e-8)], ids=["alternating", "optx"])
def test_every_solver_reaches_the_same_plane(cloud, detection, solver):
    other = detect(cloud, solver=solver, restarts=8)
    assert other.converged
    assert other.plane.angle(detection.plane) < 1e-3


def test_the_papers_own_settings_run(cloud):
    printed = dataclasses.replace(SymHKS.as_printed(), num_keypoints=200)
    assert (printed.times, printed.whitened, printed.separation, printed.restarts) == ("uniform", False, 0.0, 1)
    assert printed.solver == "alternating"
    assert symjax.detect(cloud, printed).num_used == len(cloud)


def test_the_sign_constraint_can_be_left_out(cloud):
    free = detect(cloud, num_signs=0, num_keypoints=200).pairs
    apart = np.linalg.norm(free.x - free.y, axis=1)
    assert len(free.rows) >= 3
    assert apart.min() > 0


def test_given_normals_work_as_well_as_estimated_ones(cloud, detection):
    with pytest.raises(InvalidPointsError, match="3 normals"):
        detect(cloud, normals=np.concatenate([np.zeros((3, 3)), np.ones((len(cloud) - 3, 3))]))
    with pytest.raises(InvalidPointsError, match="shape"):
        detect(cloud, normals=np.ones((5, 3)))
    estimated = local_frames(cloud, cKDTree(cloud).query(cloud, k=20)[1])[1][:, :, 0]
    assert detect(cloud, normals=-2.0 * estimated).plane.angle(detection.plane) < 2.0


@pytest.mark.parametrize(
    ("change", "error", "words"),
    [
        ({"sigma": 0.0}, InvalidArgumentError, "sigma"),
        ({"sigma": -1.0}, InvalidArgumentError, "sigma"),
        ({"sigma": float("nan")}, InvalidArgumentError, "sigma"),
        ({"restarts": 0}, InvalidArgumentError, "restarts"),
        ({"solver": "magic"}, InvalidArgumentError, "solver"),
        ({"nonfinite": "ignore"}, InvalidArgumentError, "nonfinite"),
        ({"max_points": 10}, InvalidArgumentError, "max_points"),
        ({"num_eigs": 10**6}, InvalidArgumentError, "num_eigs"),
        ({"num_eigs": 1}, InvalidArgumentError, "num_eigs"),
        ({"num_pairs": 1}, InvalidArgumentError, "num_pairs"),
        ({"separation": -1.0}, InvalidArgumentError, "separation"),
        ({"radius": 0.0}, InvalidArgumentError, "radius"),
        ({"times": "linear"}, InvalidArgumentError, "linear"),
        ({"laplacian": "cotangent"}, InvalidArgumentError, "cotangent"),
        ({"starts": "best"}, InvalidArgumentError, "best"),
        ({"sigma_spacings": 0.0}, InvalidArgumentError, "sigma_spacings"),
        ({"pairs_per_keypoint": 1.5}, InvalidArgumentError, "pairs_per_keypoint"),
    ],
)
def test_bad_options_are_refused(cloud, change, error, words):
    with pytest.raises(error, match=words):
        detect(cloud, **change)


@pytest.mark.parametrize(
    "change",
    [
        {"restarts": 2.5},
        {"num_keypoints": 50.5},
        {"num_pairs": 4.5},
        {"num_neighbours": -3},
        {"num_eigs": "a"},
        {"num_times": True},
        {"sigma": "auto"},
        {"radius": None},
        {"whitened": "no"},
    ],
)
def test_options_of_another_type_are_refused_by_the_constructor(change):
    with pytest.raises(InvalidArgumentError, match=next(iter(change))):
        SymHKS(**change)


def test_too_many_keypoints_for_the_symmetric_program_are_refused_by_the_constructor():
    assert SymHKS(symmetric=True, num_keypoints=300).symmetric
    with pytest.raises(InvalidArgumentError, match="at most 300 points; got 500: use fewer keypoints"):
        SymHKS(symmetric=True)


@pytest.mark.parametrize(
    ("points", "error"),
    [
        (np.zeros((0, 3)), TooFewPointsError),
        (np.random.default_rng(0).normal(size=(20, 3)), TooFewPointsError),
        (np.ones((3, 500)), InvalidPointsError),
        (np.full((100, 3), np.nan), NonfiniteError),
        (np.ones((100, 3)), DegenerateCloudError),
        (np.outer(np.arange(100.0), np.ones(3)), DegenerateCloudError),
    ],
)
@pytest.mark.parametrize("method", ["robust", "sym-hks"])
def test_bad_points_are_refused(points, error, method):
    with pytest.raises(error) as caught:
        symjax.detect(points, method)
    assert isinstance(caught.value, SymjaxError)


def test_dropped_rows_keep_the_original_indices(cloud):
    holed = cloud.copy()
    holed[:10] = np.nan
    detection = detect(holed, nonfinite="drop")
    np.testing.assert_array_equal(detection.pairs.x, holed[detection.pairs.rows[:, 0]])
    assert detection.pairs.rows.min() >= 10
    assert np.isfinite(detection.complete()).all()
    assert "10 of" in detection.notes[0]


def test_a_coplanar_cloud_gets_a_plane_across_it(rng):
    outline = rng.uniform(-1, 1, size=(6_000, 2))
    wide = np.abs(outline[:, 0]) < 0.2 + 0.25 * (1 + outline[:, 1]) ** 2 * (outline[:, 1] < 0.7)
    flat = np.c_[outline[wide], np.zeros(wide.sum())]
    detection = detect(flat)
    assert abs(detection.plane.normal[2]) < 1e-6
    assert detection.plane.angle(Plane(NORMAL, np.float64(0.0))) < 5.0
    assert any("coplanar" in note for note in detection.notes)


def test_a_cloud_of_two_components_has_a_note_and_a_warning(cloud):
    with pytest.warns(ComponentsWarning, match="2 connected components"):
        detection = detect(np.concatenate([cloud, cloud[::3] + [0.0, 20.0, 0.0]]))
    assert any("2 connected components" in note for note in detection.notes)


def test_an_asymmetric_cloud_has_no_plane():
    tree = symjax.datasets.generate("tree", num_points=3_000, rng=0)
    assert not detect(tree.points).found


def test_a_large_cloud_is_thinned_and_has_a_note(rng):
    detection = detect(creature(rng, 40_000))
    assert detection.num_points > 39_000
    assert detection.num_used <= 10_000
    assert any("thinned" in note for note in detection.notes)
    assert detection.plane.angle(Plane(NORMAL, np.float64(0.0))) < 3.0


def test_a_small_cloud_gets_a_plane(rng):
    detection = detect(creature(rng, 300))
    assert len(detection.pairs.rows) >= 3
    assert 0 < detection.sigma < 0.2


def test_a_point_far_away_does_no_harm(cloud):
    with pytest.warns(ComponentsWarning):
        detection = detect(np.concatenate([cloud, [[1e6, 0.0, 0.0]]]))
    assert len(detection.pairs.rows) >= 3


def test_the_flags_of_jax_are_not_changed(cloud):
    import jax

    jax.config.update("jax_enable_x64", False)
    try:
        assert detect(cloud).plane.normal.dtype == np.float64
        assert not jax.config.jax_enable_x64
    finally:
        jax.config.update("jax_enable_x64", True)
