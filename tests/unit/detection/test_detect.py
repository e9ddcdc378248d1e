"""What `detect` does for any method: it transforms the result, seeds the method, and checks the arguments first."""

import warnings
from dataclasses import dataclass, field

import numpy as np
import pytest

import symjax
from symjax.detection.summary import lines
from symjax.errors import InvalidArgumentError, InvalidPointsError, SymjaxError
from symjax.geometry.plane import Plane
from symjax.method.result import Candidate, MethodResult
from symjax.preprocess.cloud import DENSITY_POINTS, prepare


@dataclass(frozen=True)
class FirstAxis:
    """A user's method: it returns the planes across the axes of the cloud frame, the first one first."""

    name: str = "first axis"
    drops_outliers: bool = False
    seen: list = field(default_factory=list)

    def find(self, cloud, *, max_planes, rng, timer):
        with timer.stage("looking"):
            self.seen.append((cloud, max_planes, rng.random()))
        planes = [Plane(axis, np.float64(0.1 * k)) for k, axis in enumerate(np.eye(3))]
        candidates = tuple(Candidate(plane, -1.0 - k, -1.0 - k) for k, plane in enumerate(planes))
        return MethodResult(candidates, (planes[0],), "one plane", notes=("looked once",))


@pytest.fixture
def cloud(rng):
    return rng.normal(size=(400, 3)) * [3.0, 2.0, 1.0] + [5.0, 0.0, -7.0]


def test_any_method_works_and_its_result_is_in_the_units_of_the_input(cloud):
    method = FirstAxis()
    det = symjax.detect(cloud, method, max_planes=2)
    own = prepare(cloud)
    expected = own.to_given.plane(Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))).canonical()
    np.testing.assert_allclose(det.plane.normal, expected.normal, atol=1e-12)
    np.testing.assert_allclose(det.plane.offset, expected.offset, atol=1e-9)
    assert (det.method, det.found, det.symmetry, det.notes) == ("first axis", True, "one plane", ("looked once",))
    assert list(det.timings) == ["preparing", "looking"]
    assert len(det.candidates) == 2
    second = det.candidates[1].plane
    middle = own.to_given.points(np.array([0.0, 0.1, 0.0]))
    np.testing.assert_allclose(second.signed_distance(middle[None]), 0.0, atol=1e-9)


def test_what_a_method_does_not_compute_is_none_and_the_detection_still_works(cloud, tmp_path):
    det = symjax.detect(cloud, FirstAxis())
    assert (det.sigma, det.threshold, det.inlier_fraction, det.uncertainty, det.exactness) == (None,) * 5
    assert det.pairs.x.shape == (0, 3)
    det.save(tmp_path / "det.json")
    again = symjax.load(tmp_path / "det.json", points=cloud)
    np.testing.assert_array_equal(again.plane.normal, det.plane.normal)
    assert again.candidates[1].ranking_score == det.candidates[1].ranking_score
    assert det.complete().shape == (800, 3)
    assert "found     yes   (score -1.000)" in list(lines(det))
    det.plot(tmp_path / "page.html")
    det.picture(tmp_path / "picture.png")


def test_normals_reach_the_method_in_the_frame_of_the_cloud(cloud, rng):
    normals = rng.normal(size=cloud.shape)
    method = FirstAxis()
    symjax.detect(cloud, method, normals=normals)
    seen = method.seen[0][0]
    np.testing.assert_allclose(seen.to_given.directions(seen.normals), normals[seen.rows], atol=1e-12)


@pytest.mark.parametrize(
    "normals", [[[1, 2, 3], [1, 2]], np.ones((400, 2)), np.full((400, 3), "x"), np.zeros((400, 3))]
)
def test_bad_normals_are_refused(cloud, normals):
    with pytest.raises(InvalidPointsError, match="normals"):
        symjax.detect(cloud, FirstAxis(), normals=normals)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rng": -1}, "rng"),
        ({"rng": "a"}, "rng"),
        ({"rng": None}, "rng"),
        ({"rng": 1.5}, "rng"),
        ({"max_planes": 2.5}, "max_planes"),
        ({"max_planes": 0}, "max_planes"),
        ({"max_planes": True}, "max_planes"),
        ({"drop_outliers": "x"}, "drop_outliers"),
        ({"remove_ground": 1}, "remove_ground"),
        ({"max_points": "a"}, "max_points"),
        ({"max_points": float("nan")}, "max_points"),
        ({"max_points": 1000.5}, "max_points"),
        ({"method": "magic"}, "sym-hks"),
        ({"method": FirstAxis}, "Method"),
        ({"method": 3}, "Method"),
        ({"nonfinite": "ignore"}, "nonfinite"),
        ({"max_points": 10}, "max_points"),
    ],
)
def test_bad_arguments_are_refused_before_anything_is_computed(cloud, options, words):
    method = FirstAxis()
    with pytest.raises(InvalidArgumentError, match=words) as caught:
        symjax.detect(cloud, **({"method": method} | options))
    assert isinstance(caught.value, SymjaxError)
    assert not method.seen


def test_a_seed_and_a_generator_reach_the_method(cloud):
    method = FirstAxis()
    for rng in (3, np.random.default_rng(3), np.int64(3), 4):
        det = symjax.detect(cloud, method, rng=rng)
        assert det.seed == (None if isinstance(rng, np.random.Generator) else rng)
    draws = [drawn for _, _, drawn in method.seen]
    assert draws[0] == draws[1] == draws[2] != draws[3]


def test_the_generator_seeds_the_sampling_of_a_mesh(tmp_path):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 2) for z in (0, 3)], float)
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6)]
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
    triangles = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces)
    path = tmp_path / "box.obj"
    path.write_text(vertices + triangles)

    def sampled(rng):
        method = FirstAxis()
        return symjax.detect(path, method, rng=rng).points

    np.testing.assert_array_equal(sampled(np.random.default_rng(1)), sampled(np.random.default_rng(1)))
    np.testing.assert_array_equal(sampled(5), sampled(5))
    assert not np.array_equal(sampled(np.random.default_rng(1)), sampled(np.random.default_rng(2)))


def test_max_points_holds_for_a_method_that_drops_outliers(rng):
    ball = rng.normal(size=(DENSITY_POINTS + 15_000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    for asked in (40_000, 10_000):
        method = FirstAxis(drops_outliers=True)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            symjax.detect(ball * [3, 2, 1], method, max_points=asked)
        kept = len(method.seen[0][0].points)
        assert 0.5 * asked < kept <= asked
        assert asked < DENSITY_POINTS or kept > DENSITY_POINTS


def test_outliers_are_dropped_if_the_method_or_the_caller_asks_for_it(rng):
    sphere = rng.normal(size=(2000, 3))
    sphere /= np.linalg.norm(sphere, axis=1, keepdims=True)
    cloud = np.concatenate([sphere * [3, 2, 1], rng.uniform(-3, 3, size=(1000, 3))])
    counts = {}
    for drops, asked in ((True, None), (False, None), (False, True), (True, False)):
        method = FirstAxis(drops_outliers=drops)
        symjax.detect(cloud, method, drop_outliers=asked)
        counts[drops, asked] = len(method.seen[0][0].points)
    assert counts[False, None] == counts[True, False] == 3000
    assert counts[True, None] == counts[False, True] < 2500
