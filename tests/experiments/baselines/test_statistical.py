"""Baselines: principal planes, least squares of matches, RANSAC on matches and on points, and pyclarcs."""

import importlib.util
import sys

import numpy as np
import pytest
from scipy.spatial import KDTree

import symjax
from experiments.baselines import maximum_likelihood, ransac_matches
from experiments.baselines.least_squares import least_squares
from experiments.baselines.matches import matches
from experiments.baselines.maximum_likelihood import MaximumLikelihood
from experiments.baselines.pca import PCA
from experiments.baselines.pyclarcs_em import Pyclarcs
from experiments.baselines.ransac_matches import RansacOnMatches, agreement, residual
from experiments.baselines.ransac_points import (
    RansacOnPoints,
    draw_planes,
    num_draws_needed,
    vote_ratios,
    vote_until_confident,
)
from experiments.data.cases import generate_case, kinds_of
from experiments.metrics.deviation import deviation
from experiments.metrics.ranking import distinct, plane_distance
from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import DegenerateCloudError, TooFewPointsError
from symjax.geometry.directions import deviation_angle
from symjax.geometry.plane import Plane
from symjax.preprocess.cloud import prepare

TEN = kinds_of("single", 10)

WELL_MATCHED = ("sofa", "car", "boat", "bicycle", "quadruped", "fish", "head", "teapot", "hammer", "coat_hook")
"""Kinds on which at least two matches in five join points that are nearly mirror images.

Least squares weights all matches equally, so that with more wrong matches its plane may be far from the true one.
"""

needs_pyclarcs = pytest.mark.skipif(importlib.util.find_spec("pyclarcs") is None, reason="pyclarcs is not installed")


@pytest.fixture
def one_thread():
    """Limits pyclarcs to one thread: its threads wait by spinning, which takes ten times as long on a busy machine."""
    if importlib.util.find_spec("numba") is None:
        yield
        return
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(1)
    yield
    numba.set_num_threads(before)


@pytest.fixture(scope="module")
def fish():
    return generate_case("fish", 1500, 0)


def mirrored(rng, normal, offset, half=300):
    """An asymmetric cloud and its mirror image."""
    one = rng.gamma(2.0, size=(half, 3)) * (1.0, 0.6, 0.3)
    return np.concatenate([one, Plane(normal, offset).reflect(one)])


def unit(rng):
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def deviations(method, cases):
    return [deviation(method.rank(case.points, np.random.default_rng(0)).plane(), case) for case in cases]


def assert_mostly_right(method, cases):
    found = deviations(method, cases)
    assert np.mean([off.angle < 5 for off in found]) >= 0.9
    assert np.mean([off.correct for off in found]) >= 0.9


def test_principal_planes_are_right_on_clean_clouds():
    assert_mostly_right(PCA(), [generate_case(kind, 3000, 0) for kind in TEN])


@pytest.mark.slow
def test_ransac_on_matches_is_right_on_clean_clouds():
    assert_mostly_right(RansacOnMatches(), [generate_case(kind, 2000, 0) for kind in TEN])


@pytest.mark.slow
def test_least_squares_is_right_if_enough_matches_are(monkeypatch):
    matched = [generate_case(kind, 2000, 0) for kind in WELL_MATCHED]
    made_once = {id(case.points): matches(case.points, np.random.default_rng(0)) for case in matched}
    monkeypatch.setattr(maximum_likelihood, "matches", lambda points, rng: made_once[id(points)])
    for case in matched:
        frame, x, y = made_once[id(case.points)]
        off = residual(*frame.to_given.inverse().plane(case.planes[0]), x, y)
        assert np.mean(off < 0.15) > 0.4
    assert_mostly_right(MaximumLikelihood(), matched)
    assert_mostly_right(MaximumLikelihood(as_printed=True), matched)


@pytest.mark.slow
def test_ransac_on_points_is_right_on_clean_clouds():
    assert_mostly_right(RansacOnPoints(), [generate_case(kind, 1000, 0) for kind in TEN])


@pytest.mark.slow
@needs_pyclarcs
def test_pyclarcs_is_right_on_clean_clouds(one_thread):
    assert_mostly_right(Pyclarcs(), [generate_case(kind, 400, 0) for kind in TEN])


def test_principal_planes_pass_through_the_mean_and_are_perpendicular(fish):
    found = PCA().rank(fish.points, np.random.default_rng(0))
    np.testing.assert_allclose(found.normals @ found.normals.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(found.normals @ fish.points.mean(axis=0), found.offsets)
    assert (np.diff(found.scores) <= 0).all()
    few = PCA(max_points=400).rank(fish.points, np.random.default_rng(0))
    assert few.plane().angle(found.plane()) < 10


@pytest.mark.parametrize("method", [PCA(), RansacOnPoints()], ids=lambda method: method.name)
def test_a_planted_plane_is_found(method, rng):
    normal, offset = unit(rng), 0.7
    found = method.rank(mirrored(rng, normal, offset), rng)
    assert plane_distance(Plane(found.normals, found.offsets), Plane(normal, offset))[0] < 1e-6


def test_the_matches_are_those_that_sym_hks_fits(fish, monkeypatch):
    class Fitting(Exception):
        """Raised instead of the fit, which would compile for seconds."""

    def search(*pairs, **_):
        raise Fitting(*pairs[:2])

    monkeypatch.setattr("symjax.symhks.plane_fit.fit_candidates", search)
    with pytest.raises(Fitting) as reached:
        symjax.detect(fish.points, "sym-hks")
    cloud = prepare(fish.points)
    frame, *ends = matches(fish.points, np.random.default_rng(0))
    for own, end in zip(reached.value.args, ends, strict=True):
        given = cloud.to_given.points(np.asarray(own))
        np.testing.assert_allclose(frame.to_given.points(end), given, atol=1e-12)


def test_the_score_of_least_squares_is_the_residual_of_its_matches(fish):
    found = MaximumLikelihood().rank(fish.points, np.random.default_rng(0))
    frame, x, y = matches(fish.points, np.random.default_rng(0))
    off = residual(*frame.to_given.inverse().plane(found.plane()), x, y)
    np.testing.assert_allclose(found.scores, [-np.sqrt(np.mean(off**2))])


def test_the_printed_matrix_is_right_only_if_the_mid_points_are_centred():
    p = planted_pairs(np.random.default_rng(2), 200, 0.0, shift=0.3)
    mean = (p.x + p.y).mean(axis=0) / 2
    printed, corrected = (least_squares(p.x, p.y, as_printed=flag)[0] for flag in (True, False))
    assert deviation_angle(printed, p.normal) > 5
    assert deviation_angle(corrected, p.normal) < 0.2
    centred, offset = least_squares(p.x - mean, p.y - mean, as_printed=True)
    assert deviation_angle(centred, p.normal) < 0.2
    assert offset == pytest.approx(0, abs=1e-12)


@pytest.mark.parametrize("blob", ["thin", "wide"])
def test_consensus_withstands_outliers_that_mislead_least_squares(blob):
    p = planted_pairs(np.random.default_rng(3), 300, 0.8, blob, shift=0.3)
    normals, offsets, scores = RansacOnMatches().consensus(p.x, p.y, np.random.default_rng(0))
    assert deviation_angle(normals[0], p.normal) < 1
    assert abs(offsets[0] * np.sign(normals[0] @ p.normal) - p.offset) < 0.02
    assert scores[0] > 0.15
    assert deviation_angle(least_squares(p.x, p.y)[0], p.normal) > 5


def test_agreement_is_1_for_exact_pairs_and_0_beyond_the_threshold(rng):
    p = planted_pairs(rng, 60, 0.0, noise=0.0)
    normals, offsets = np.stack([p.normal, p.normal]), np.array([p.offset, p.offset + 0.1])
    np.testing.assert_allclose(agreement(normals, offsets, p.x, p.y, 0.15), [1, 0], atol=1e-12)
    # a shift of the plane by d moves every mirror image by 2 d
    assert agreement(normals, offsets, p.x, p.y, 0.4)[1] == pytest.approx(1 - 0.25)


def test_consensus_keeps_distinct_planes_best_first():
    p = planted_pairs(np.random.default_rng(4), 100, 0.7)
    normals, offsets, scores = RansacOnMatches(max_planes=4).consensus(p.x, p.y, np.random.default_rng(0))
    assert 1 < len(scores) <= 4
    assert (np.diff(scores) <= 0).all()
    assert len(distinct(normals, offsets, scores, apart=ransac_matches.APART, most=4)) == len(scores)


def test_a_drawn_plane_exchanges_its_two_points(rng):
    points = rng.normal(size=(2, 3)) + 5.0
    normals, offsets = draw_planes(points, 20, rng)
    assert 0 < len(normals) < 20  # a point that is drawn with itself gives no plane
    for normal, offset in zip(normals, offsets, strict=True):
        np.testing.assert_allclose(Plane(normal, offset).reflect(points), points[::-1], atol=1e-12)


def test_the_vote_ratio_is_the_share_of_images_that_meet_the_cloud(rng):
    normal, offset = unit(rng), 0.3
    tree = KDTree(mirrored(rng, normal, offset))
    normals, offsets = np.stack([normal, normal]), np.array([offset, offset + 50])
    np.testing.assert_array_equal(vote_ratios(normals, offsets, tree.data, tree, 1e-6), [1, 0])


@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.9])
def test_drawing_stops_when_two_inliers_are_likely_enough(ratio):
    end = num_draws_needed(np.full(2000, ratio), 0.95)
    assert 1 - (1 - ratio**2) ** end >= 0.95
    assert 1 - (1 - ratio**2) ** (end - 1) < 0.95
    assert num_draws_needed(np.full(end - 1, ratio), 0.95) is None
    # the best plane so far decides
    assert num_draws_needed(np.append(ratio, np.zeros(2000)), 0.95) == end


def test_planes_drawn_after_the_end_are_ignored(fish):
    tree = KDTree(fish.points)
    planes = draw_planes(fish.points, 300, np.random.default_rng(0))
    everything = vote_until_confident(*planes, fish.points, tree, 0.05, None)
    early = vote_until_confident(*planes, fish.points, tree, 0.05, 0.95)
    assert len(everything) == len(planes[1])
    np.testing.assert_array_equal(early, everything[: num_draws_needed(everything, 0.95)])


METHODS = {
    "pca": PCA(),
    "maximum likelihood": MaximumLikelihood(),
    "maximum likelihood, as printed": MaximumLikelihood(as_printed=True),
    "ransac over matches": RansacOnMatches(),
    "ransac over points": RansacOnPoints(),
    "pyclarcs": pytest.param(Pyclarcs(), marks=needs_pyclarcs),
}


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)
def test_the_plane_moves_with_the_cloud(method, fish, rng, one_thread):
    few = fish.points[:600]
    found = method.rank(few, np.random.default_rng(1))
    turn, shift, scale = np.eye(3)[[2, 0, 1]] * (1, -1, 1), rng.normal(size=3) * 10, 37.0
    if not isinstance(method, Pyclarcs):  # its scale depends on the box along the axes
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    moved = method.rank(scale * few @ turn.T + shift, np.random.default_rng(1))
    length = np.linalg.norm(few - few.mean(axis=0), axis=1).mean()
    for k, normal in enumerate(found.normals):
        normal = turn @ normal
        offset = scale * found.offsets[k] + normal @ shift
        sign = np.sign(normal @ moved.normals[k])
        assert deviation_angle(moved.normals[k], normal) < 1e-3
        assert abs(sign * moved.offsets[k] - offset) < 1e-5 * scale * length
    np.testing.assert_allclose(moved.scores, found.scores, rtol=1e-6)


@pytest.mark.parametrize("method", [RansacOnMatches(), RansacOnPoints(max_draws=500)])
def test_same_generator_same_planes(method, fish):
    first, second = (method.rank(fish.points, np.random.default_rng(7)) for _ in range(2))
    for left, right in zip(first, second, strict=True):
        np.testing.assert_array_equal(left, right)


@pytest.mark.parametrize("method", [MaximumLikelihood(), RansacOnMatches()])
def test_clouds_without_a_surface_are_refused(method, rng):
    with pytest.raises(DegenerateCloudError):
        method.rank(np.ones((100, 3)), rng)
    with pytest.raises(TooFewPointsError):
        method.rank(rng.normal(size=(20, 3)), rng)


def test_the_error_names_a_missing_package(monkeypatch, fish, rng):
    monkeypatch.setitem(sys.modules, "pyclarcs", None)
    monkeypatch.setitem(sys.modules, "pyclarcs.coarse", None)
    with pytest.raises(ImportError, match="pip install pyclarcs"):
        Pyclarcs().rank(fish.points, rng)
