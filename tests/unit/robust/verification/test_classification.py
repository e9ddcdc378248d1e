"""Classification of whole detections: one plane, several planes, an axis, a sphere, or none."""

from functools import cache

import numpy as np
import pytest

import symjax
from symjax.datasets import build, generate, pose, remove_part
from symjax.geometry.distance import offset_error
from symjax.geometry.plane import Plane

NUM = 2_000
"""Points of most clouds. They fit the smallest padded size, so that the tests share the compiled programs."""


@cache
def sample_of(kind, seed=0):
    return pose(generate(kind, num_points=NUM, rng=seed), seed + 1)


@cache
def detection_of(kind, seed=0):
    return symjax.detect(sample_of(kind, seed).points)


def angle_to(direction, other):
    return np.degrees(np.arccos(np.clip(abs(direction @ other) / np.linalg.norm(direction), 0, 1)))


def near(plane, truth, found):
    """Returns whether a plane equals another one, up to 0.5° and 0.005 diagonals."""
    centre = found.points.mean(axis=0)
    return plane.angle(truth) < 0.5 and offset_error(plane, truth, centre, found.diagonal) < 0.005


def body_of_a_mug():
    """Returns a mug reduced to its body of revolution, without handle, lip and dots."""
    mug, field = generate("mug", num_points=2 * NUM, rng=0), build("mug", 0).field
    turns = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    x, y, z = mug.points.T
    around = [np.stack([np.cos(t) * x - np.sin(t) * y, np.sin(t) * x + np.cos(t) * y, z]) for t in turns]
    on_surface = np.mean([np.abs(field(p)) < 0.005 for p in around], axis=0)
    return pose(mug._replace(points=mug.points[on_surface > 0.7][:NUM]), 1)


def test_a_block_has_three_planes_and_is_ambiguous():
    found, truth = detection_of("block"), sample_of("block")
    assert (found.found, found.ambiguous, found.symmetry, found.axis) == (True, True, "several planes", None)
    for normal, offset in truth.planes:
        rank = [i for i, c in enumerate(found.candidates) if near(c.plane, Plane(normal, offset), found)]
        assert len(rank) == 1
        assert rank[0] < 3
        assert found.candidates[rank[0]].score > found.threshold


def test_only_the_true_planes_of_a_block_score_high():
    scores = [candidate.score for candidate in detection_of("block").candidates]
    assert min(scores[:3]) > 0.9
    assert max(scores[3:]) < 0.8


def test_a_cube_has_nine_planes():
    found, truth = detection_of("cube"), sample_of("cube")
    assert (found.found, found.ambiguous, found.symmetry) == (True, True, "several planes")
    for normal, offset in truth.planes:
        assert sum(near(c.plane, Plane(normal, offset), found) for c in found.candidates) == 1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_drum_has_an_axis(seed):
    found, truth = detection_of("drum", seed), sample_of("drum", seed)
    assert (found.found, found.ambiguous, found.symmetry) == (True, True, "axis")
    point, direction = found.axis
    assert angle_to(direction, truth.axis[1]) < 3
    beside = point - truth.axis[0]
    beside -= beside @ truth.axis[1] * truth.axis[1]
    assert np.linalg.norm(beside) < 0.01 * found.diagonal
    # every mirror plane of a drum contains the axis or is perpendicular to it
    for candidate in found.candidates:
        tilt = angle_to(candidate.plane.normal, truth.axis[1])
        assert min(tilt, 90 - tilt) < 3


def test_a_ball_is_a_sphere_about_its_centre():
    found, truth = detection_of("ball"), sample_of("ball")
    assert (found.found, found.ambiguous, found.symmetry) == (True, True, "sphere")
    assert np.linalg.norm(found.axis[0] - truth.axis[0]) < 0.01 * found.diagonal


@cache
def detection_of_a_cut_ball():
    return symjax.detect(remove_part(sample_of("ball").points, 0.28, 0)[0])


def test_the_planes_of_a_cut_ball_contain_its_centre():
    ball, found = sample_of("ball"), detection_of_a_cut_ball()
    assert (found.found, found.ambiguous) == (True, True)
    for candidate in found.candidates[:5]:
        assert abs(candidate.plane.normal @ ball.axis[0] - candidate.plane.offset) < 0.005 * found.diagonal


def test_a_cut_ball_is_a_sphere_about_its_centre():
    ball, found = sample_of("ball"), detection_of_a_cut_ball()
    assert found.symmetry == "sphere"
    assert np.linalg.norm(found.axis[0] - ball.axis[0]) < 0.01 * found.diagonal


@pytest.mark.parametrize("kind", ["quadruped", "human", "chair", "fish"])
def test_an_object_with_one_plane_is_classified_as_one_plane(kind):
    found, truth = detection_of(kind), sample_of(kind)
    assert (found.found, found.ambiguous, found.symmetry, found.axis) == (True, False, "one plane", None)
    assert found.plane.angle(Plane(*truth.planes[0])) < 1


@pytest.mark.parametrize(("kind", "count"), [("block", 3), ("cube", 9), ("prism", 8), ("pyramid", 6)])
def test_all_planes_of_an_object_with_several_are_found(kind, count):
    found, truth = detection_of(kind), sample_of(kind)
    assert len(truth.planes) == len(found.planes) == count
    for normal, offset in truth.planes:
        assert sum(near(plane, Plane(normal, offset), found) for plane in found.planes) == 1


@pytest.mark.parametrize("seed", [0, 1])
def test_a_body_of_revolution_with_a_handle_has_one_plane(seed):
    """All planes through the axis of a jug score nearly as high as the mirror plane, but no valley separates them."""
    found = symjax.detect(pose(generate("jug", num_points=5000, rng=seed), seed + 1).points)
    assert min(candidate.score for candidate in found.candidates[:4]) > 0.85 * found.score
    assert (found.symmetry, found.ambiguous, len(found.planes)) == ("one plane", False, 1)


@pytest.mark.parametrize("kind", ["scrap", "tree", "hand"])
def test_an_object_without_a_plane_is_classified_as_none(kind):
    found = detection_of(kind)
    assert (found.found, found.ambiguous, found.symmetry, found.axis) == (False, False, "none", None)
    assert found.score <= found.threshold
    assert found.candidates


def test_a_mug_without_its_handle_is_ambiguous():
    whole, body = detection_of("mug"), body_of_a_mug()
    assert (whole.found, whole.ambiguous) == (True, False)
    found = symjax.detect(body.points)
    assert (found.found, found.ambiguous, found.symmetry) == (True, True, "axis")
    assert angle_to(found.axis[1], pose(generate("mug", num_points=10, rng=0), 1).normals[0]) > 85
    # other planes through the axis are as good as the plane of the removed handle
    assert min(c.score for c in found.candidates[:4]) > 0.9 * found.score


@pytest.mark.parametrize("kind", ["block", "drum", "quadruped", "tree"])
def test_found_and_ambiguous_and_symmetry_agree(kind):
    found = detection_of(kind)
    assert found.found == (found.symmetry != "none") == (found.score > found.threshold)
    assert not (found.ambiguous and found.symmetry == "none")
    assert (found.axis is not None) == (found.symmetry in ("axis", "sphere"))
    # unrefined candidates rank behind, whatever their score on a thousand points
    refined = [candidate.exactness is not None for candidate in found.candidates]
    assert refined == sorted(refined, reverse=True)


@pytest.mark.parametrize("kind", ["block", "drum"])
def test_the_symmetry_does_not_depend_on_max_planes(kind):
    found, one = detection_of(kind), symjax.detect(sample_of(kind).points, max_planes=1)
    assert len(one.candidates) == 1
    assert (one.symmetry, one.ambiguous) == (found.symmetry, found.ambiguous)


@pytest.mark.parametrize("kind", ["block", "cube", "quadruped", "human", "tree"])
def test_the_planes_are_exactly_the_true_ones(kind):
    found, truth = detection_of(kind), sample_of(kind)
    assert len(found.planes) == len(truth.planes)
    for normal, offset in truth.planes:
        assert sum(near(plane, Plane(normal, offset), found) for plane in found.planes) == 1
    assert not found.planes or np.array_equal(found.planes[0].normal, found.plane.normal)
