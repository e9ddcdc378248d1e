"""Corruptions and scans from one side: how many points are kept, which ones, and how seeds change them."""

import numpy as np
import pytest
from scipy.stats import kstest

from symjax.datasets import add_noise, add_outliers, build, corrupt, generate, load, pose, remove_part, scan
from symjax.errors import InvalidArgumentError, SymjaxError, TooFewPointsError


@pytest.fixture
def ball(rng):
    p = rng.normal(size=(2000, 3))
    return p / np.linalg.norm(p, axis=1, keepdims=True)


@pytest.mark.parametrize("alpha", [0.0, 0.2, 1.0, 3.0])
def test_outliers_follow_the_points_and_fill_the_box(ball, alpha):
    stretched = ball * [1, 2, 3] + [5, 0, -7]
    points = add_outliers(stretched, alpha, 0)
    assert len(points) == 2000 + int(alpha * 2000)
    np.testing.assert_array_equal(points[:2000], stretched)
    outliers = points[2000:]
    low, high = stretched.min(axis=0), stretched.max(axis=0)
    for k in range(3) if alpha else ():
        assert kstest(outliers[:, k], "uniform", (low[k], high[k] - low[k])).pvalue > 1e-3


@pytest.mark.parametrize("gamma", [0.0, 0.15, 0.4])
def test_the_removed_part_is_inside_a_ball_around_a_point(ball, gamma):
    points, kept = remove_part(ball, gamma, 5)
    assert len(points) == 2000 - int(gamma * 2000)
    np.testing.assert_array_equal(points, ball[kept])
    assert np.all(np.diff(kept) > 0)
    gone = np.setdiff1d(np.arange(2000), kept)
    if gamma:
        centre = ball[gone].mean(axis=0)
        centre /= np.linalg.norm(centre)
        # the cap that holds a fraction γ of a unit sphere's area lies above height 1 - 2γ
        assert np.quantile(ball[gone] @ centre, 0.02) > 1 - 2 * gamma - 0.1
        assert (points @ centre).max() < 1 - 2 * gamma + 0.1


def test_noise_has_the_given_level(ball):
    diagonal = np.linalg.norm(np.ptp(ball, axis=0))
    moved = add_noise(ball, 0.01, 1) - ball
    assert kstest(moved.ravel() / (0.01 * diagonal), "norm").pvalue > 1e-3
    np.testing.assert_allclose(add_noise(ball, 0.01, 1, diagonal=2 * diagonal) - ball, 2 * moved, atol=1e-12)


def test_a_scan_contains_the_near_cap_of_a_sphere(ball):
    viewpoint = np.array([0.0, 0.0, 4.0])
    points, seen = scan(ball, viewpoint=viewpoint)
    np.testing.assert_array_equal(points, ball[seen])
    horizon = 1 / 4  # the tangent cone touches the sphere at z = radius² / distance
    # the method keeps some hidden points just behind the horizon, but none on the far side
    assert np.mean(points[:, 2] > horizon - 0.1) > 0.93
    assert points[:, 2].min() > -0.75
    visible = np.flatnonzero(ball[:, 2] > horizon + 0.1)
    assert np.isin(visible, seen).mean() > 0.98


def test_points_behind_a_wall_are_hidden(rng):
    wall = np.column_stack([rng.uniform(-1, 1, (3000, 2)), np.zeros(3000)])
    behind = np.column_stack([rng.uniform(-0.4, 0.4, (300, 2)), np.full(300, -1.0)])
    _, seen = scan(np.vstack([wall, behind]), viewpoint=np.array([0.0, 0.0, 6.0]))
    assert np.count_nonzero(seen < 3000) > 2700
    assert np.count_nonzero(seen >= 3000) < 10


def test_the_viewpoint_depends_on_the_seed_and_moves_with_the_cloud(ball):
    first, other = scan(ball, 0)[1], scan(ball, 1)[1]
    assert 0.25 < len(first) / 2000 < 0.6
    assert len(np.setdiff1d(first, other)) > 50
    np.testing.assert_array_equal(scan(10 * ball + 3, 0)[1], first)


def test_corrupt_applies_the_corruptions_in_order(ball):
    result = corrupt(ball, 7, outliers=0.5, missing=0.28, noise=0.002, one_sided=True)
    from_cloud = result.source >= 0
    seen = np.count_nonzero(from_cloud)
    assert np.count_nonzero(~from_cloud) == int(0.5 * seen)
    assert len(np.unique(result.source[from_cloud])) == seen
    whole = corrupt(ball, 7, one_sided=True).source
    assert seen == len(whole) - int(0.28 * len(whole))
    assert np.isin(result.source[from_cloud], whole).all()
    shift = np.linalg.norm(result.points[from_cloud] - ball[result.source[from_cloud]], axis=1)
    level = 0.002 * np.linalg.norm(np.ptp(ball, axis=0))  # the diagonal of the whole cloud
    assert 0.9 < shift.std() / (level * np.sqrt(3 - 8 / np.pi)) < 1.1
    assert not np.all(np.diff(result.source[from_cloud]) > 0)


def test_without_corruptions_the_cloud_is_only_shuffled(ball):
    result = corrupt(ball, 3)
    np.testing.assert_array_equal(result.points, ball[result.source])
    assert len(np.unique(result.source)) == 2000


def test_the_same_seed_gives_the_same_corruption(ball):
    asked = {"outliers": 0.3, "missing": 0.1, "noise": 0.01, "one_sided": True}
    first, again, other = (corrupt(ball, seed, **asked) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.points, again.points)
    assert first.points.shape != other.points.shape or not np.allclose(first.points, other.points)


def test_bad_arguments_are_refused(ball):
    with pytest.raises(InvalidArgumentError, match="alpha"):
        add_outliers(ball, -0.1)
    with pytest.raises(InvalidArgumentError, match="gamma"):
        remove_part(ball, 1.0)
    with pytest.raises(InvalidArgumentError, match="level must be a finite number, at least 0"):
        add_noise(ball, -1.0)
    with pytest.raises(TooFewPointsError, match="got 3"):
        scan(ball[:3])
    with pytest.raises(InvalidArgumentError, match="point 17"):
        scan(ball, viewpoint=ball[17])


CALLS = {
    "generate, num_points": lambda: generate("mug", num_points="a"),
    "generate, rng": lambda: generate("mug", rng=-1),
    "build, rng": lambda: build("mug", rng="a"),
    "load, num_samples": lambda: load("spot", num_samples=1.5),
    "pose, rng": lambda: pose(generate("ball", num_points=10), rng=-1),
    "pose, scale": lambda: pose(generate("ball", num_points=10), scale="a"),
    "pose, shift": lambda: pose(generate("ball", num_points=10), shift=None),
    "add_outliers, alpha": lambda: add_outliers([[0, 0, 0]], "a"),
    "add_outliers, points": lambda: add_outliers([[0, 0], [0, 0]], 1.0),
    "add_outliers, nan": lambda: add_outliers([[0, 0, np.nan]], 1.0),
    "remove_part, empty": lambda: remove_part(np.empty((0, 3)), 0.5),
    "remove_part, gamma": lambda: remove_part([[0, 0, 0]], None),
    "add_noise, diagonal": lambda: add_noise([[0, 0, 0]], 0.1, diagonal=-1),
    "corrupt, one_sided": lambda: corrupt([[0, 0, 0]], one_sided="yes"),
    "corrupt, rng": lambda: corrupt([[0, 0, 0]], rng=1.5),
    "scan, viewpoint": lambda: scan(np.eye(4)[:, :3], viewpoint="above"),
    "scan, plane": lambda: scan([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], viewpoint=[5, 5, 0]),
}


@pytest.mark.parametrize("name", CALLS)
def test_bad_input_raises_an_error_of_symjax(name):
    with pytest.raises(SymjaxError):
        CALLS[name]()


def test_lists_are_accepted():
    points = [[0, 0, 0], [1, 2, 3], [0, 2, 0], [2, 0, 1]]
    assert add_outliers(points, 1.0).shape == (8, 3)
    assert remove_part(points, 0.5)[0].shape == (2, 3)
    assert add_noise(points, 0.0).tolist() == points
    assert len(scan(points, viewpoint=[9, 9, 9])[0]) > 0
    assert corrupt(points, outliers=0.5).points.shape == (6, 3)
