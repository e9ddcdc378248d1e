"""Uniform outliers are removed; a surface that is whole, cut, noisy or scanned from one side loses very few points."""

import re
from functools import cache

import numpy as np
import pytest
from scipy.spatial import cKDTree

from symjax.datasets import add_noise, add_outliers, generate, pose, remove_part, scan
from symjax.datasets.sample import random_orthogonal
from symjax.preprocess.cloud import DENSITY_POINTS, prepare
from symjax.preprocess.outliers import otsu_threshold, outlier_mask

KINDS = ["chair", "quadruped", "human", "aeroplane", "tree", "table", "spectacles", "ring", "ball"]
NUM = 3_000


@cache
def object_of(kind, num_points=NUM):
    return pose(generate(kind, num_points=num_points, rng=1), 1).points


def spacing(points):
    return np.median(cKDTree(points).query(points, k=7)[0][:, 6]) / np.sqrt(6 / np.pi)


@pytest.mark.parametrize("shape", ["two peaks", "one peak", "skewed", "even"])
def test_otsus_threshold_minimises_the_variance_within_the_classes(rng, shape):
    values = {
        "two peaks": np.concatenate([rng.normal(0, 1, 900), rng.normal(6, 0.5, 300)]),
        "one peak": rng.normal(size=1_000),
        "skewed": rng.exponential(size=1_000),
        "even": rng.uniform(size=1_000),
    }[shape]

    def within(threshold):
        parts = values[values <= threshold], values[values > threshold]
        return sum(len(part) * part.var() for part in parts if len(part)) / len(values)

    brute = min(within(threshold) for threshold in np.sort(values)[:-1])
    assert within(otsu_threshold(values)) < 1.01 * brute
    assert within(otsu_threshold(values, num_bins=1_024)) < 1.001 * brute


def test_otsus_threshold_lies_between_two_clusters_and_is_equivariant(rng):
    values = np.concatenate([rng.uniform(0, 1, 500), rng.uniform(5, 6, 20)])
    threshold = otsu_threshold(values)
    assert 1 <= threshold + 1e-12 < 5
    np.testing.assert_allclose(otsu_threshold(3 * values - 7), 3 * threshold - 7, rtol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_whole_cut_or_noisy_surface_loses_nothing(kind):
    points = object_of(kind)
    assert not outlier_mask(points).any()
    assert not outlier_mask(remove_part(points, 0.28, 2)[0]).any()
    for level in (0.005, 0.01):
        assert outlier_mask(add_noise(points, level, 3)).mean() < 0.01


@pytest.mark.parametrize("kind", ["chair", "sofa", "jug", "bird", "ball", "three_axis_ellipsoid"])
def test_a_scan_with_a_half_empty_hull_loses_nothing(kind):
    points = pose(generate(kind, num_points=1_500, rng=0), 0).points
    for seed in (0, 1):
        assert outlier_mask(scan(points, seed)[0]).mean() < 0.01


@pytest.mark.parametrize(
    ("kind", "seed", "num_points", "noise"),
    [("desk", 0, 2_000, 0.0), ("vase", 0, 3_000, 0.0), ("bowl", 2, 1_500, 0.005), ("jug", 2, 3_000, 0.01)],
)
def test_a_small_hollow_or_noisy_surface_loses_nothing(kind, seed, num_points, noise):
    points = pose(generate(kind, num_points=num_points, rng=seed), seed).points
    assert outlier_mask(add_noise(points, noise, seed)).mean() < 0.01


@pytest.mark.parametrize("alpha", [0.2, 0.6, 1.0])
@pytest.mark.parametrize("kind", ["chair", "quadruped", "human", "aeroplane", "tree", "table", "spectacles"])
def test_most_outliers_are_removed_and_the_surface_is_kept(kind, alpha):
    surface = object_of(kind)
    points = add_outliers(surface, alpha, 5)
    dropped = outlier_mask(points)
    far = cKDTree(surface).query(points)[0] > 3 * spacing(surface)
    assert dropped[NUM:].mean() > 0.7
    assert dropped[far].mean() > 0.97
    assert dropped[:NUM].mean() < 0.02


@pytest.mark.parametrize("kind", ["chair", "quadruped", "human", "spectacles"])
def test_three_outliers_per_point_are_removed_too(kind):
    points = add_outliers(object_of(kind), 3.0, 5)
    dropped = outlier_mask(points)
    assert dropped[NUM:].mean() > 0.75
    assert dropped[:NUM].mean() < 0.05


def test_more_outliers_do_not_hide_each_other():
    surface = object_of("quadruped")
    left = [np.count_nonzero(~outlier_mask(add_outliers(surface, alpha, 5))[NUM:]) / NUM for alpha in (0.2, 1.0, 3.0)]
    assert left[0] < 0.06
    assert left[1] < 0.25
    assert left[2] < 0.75


@pytest.mark.parametrize("change", ["rotation", "reflection", "scale", "shift", "order"])
def test_pose_units_and_order_do_not_matter(rng, change):
    points = add_outliers(object_of("quadruped"), 1.0, 5)
    dropped = outlier_mask(points)
    if change == "order":
        order = rng.permutation(len(points))
        same = outlier_mask(points[order]) == dropped[order]
    else:
        turn = random_orthogonal(rng, reflect=change == "reflection") if "tion" in change else np.eye(3)
        scale = 1e-6 if change == "scale" else 1.0
        shift = rng.normal(size=3) * 1e3 if change == "shift" else np.zeros(3)
        same = outlier_mask(scale * points @ turn.T + shift) == dropped
    assert same.mean() > 0.998


def test_one_point_far_away_is_dropped_and_no_other(rng):
    points = object_of("mug")
    for far in ([30.0, 0.0, 0.0], [1e6, -1e6, 1e6]):
        dropped = outlier_mask(np.vstack([points, points.mean(axis=0) + far]))
        assert dropped[-1]
        assert dropped.sum() == 1


def test_uniform_points_without_a_surface_are_kept(rng):
    # no denser part could be the surface
    assert outlier_mask(rng.uniform(size=(NUM, 3))).mean() < 0.01


@pytest.mark.parametrize("count", [1, 2, 5, 12, 13, 14, 40])
def test_few_points_do_not_raise(rng, count):
    assert outlier_mask(rng.normal(size=(count, 3))).shape == (count,)


def test_a_dozen_points_are_too_few_for_outliers(rng):
    assert not outlier_mask(rng.normal(size=(12, 3))).any()


def test_flat_clouds_grids_lines_and_doubled_points_lose_nothing(rng):
    flat = np.c_[rng.normal(size=(500, 2)), np.zeros(500)]
    grid = np.stack(np.meshgrid(np.arange(20.0), np.arange(20.0), [0.0]), axis=-1).reshape(-1, 3)
    line = np.outer(np.arange(50.0), [1, 2, 3])
    assert not outlier_mask(grid).any()
    assert not outlier_mask(line).any()
    assert outlier_mask(flat).mean() < 0.02
    ball = object_of("ball")
    assert not outlier_mask(np.vstack([ball, ball])).any()


def test_a_note_counts_the_removed_outliers_and_the_points_searched(rng):
    ball = rng.normal(size=(DENSITY_POINTS + 2_000, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    outliers = 1.2 * ball[:100] * rng.uniform(1, 2, size=(100, 1))
    cloud = prepare(np.concatenate([ball, outliers]), max_points=40_000, drop_outliers=True)
    assert cloud.cleaned
    assert re.fullmatch(r"\d+ of 32100 points are outliers and were removed", cloud.notes[0])
    both = ("outliers and the ground plane", True, True)
    for sought, drop, ground in (("outliers", True, False), ("the ground plane", False, True), both):
        cloud = prepare(ball, drop_outliers=drop, remove_ground=ground)
        assert f"the search for {sought} used a random sample of 30000 of the 32000 points" in cloud.notes
