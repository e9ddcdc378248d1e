"""An unevenly sampled surface loses nothing to the search for outliers, and outliers go however they are strewn."""

from functools import cache

import numpy as np
import pytest

from symjax.datasets import generate, pose, scan
from symjax.preprocess.cloud import prepare
from symjax.preprocess.outliers import MIN_VOID, outlier_mask, void_radius

STREWN = ["box", "large box", "half a box", "Gaussian", "shell", "clutter"]
NUM = 1_500


@cache
def densely_sampled(kind, seed=0):
    return pose(generate(kind, num_points=15_000, rng=seed), seed).points


def unevenly_sampled(kind, pattern, num_points=NUM, seed=0):
    points = densely_sampled(kind, seed)
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=3)
    height = points @ direction / np.linalg.norm(direction)
    centre, diagonal = points.mean(axis=0), np.linalg.norm(np.ptp(points, axis=0))
    if pattern == "gradient":
        density = 30 ** ((height - height.min()) / np.ptp(height))
    elif pattern == "two parts":
        density = np.where(height > np.quantile(height, 0.7), 30.0, 1.0)
    elif pattern == "twelve parts":
        seeds = rng.choice(points, 12)
        part = np.argmin(((points[:, None] - seeds) ** 2).sum(axis=2), axis=1)
        density = 30 ** rng.uniform(size=12)[part]
    else:  # the scanner is near
        viewpoint = centre + 0.6 * diagonal * direction / np.linalg.norm(direction)
        density = np.linalg.norm(points - viewpoint, axis=1) ** -3.0
    return points[rng.choice(len(points), num_points, replace=False, p=density / density.sum())]


def strewn(points, how, count, seed=0):
    rng = np.random.default_rng(seed)
    low, high = points.min(axis=0), points.max(axis=0)
    centre, diagonal = (low + high) / 2, np.linalg.norm(high - low)
    if how == "box":
        return rng.uniform(low, high, (count, 3))
    if how == "large box":
        return centre + rng.uniform(-0.9, 0.9, (count, 3)) * (high - low)
    if how == "half a box":
        return rng.uniform(low, np.r_[centre[0], high[1:]], (count, 3))
    if how == "Gaussian":
        return centre + 0.2 * diagonal * rng.normal(size=(count, 3))
    if how == "shell":
        direction = rng.normal(size=(count, 3))
        radius = diagonal * rng.uniform(0.4, 0.6, (count, 1))
        return centre + radius * direction / np.linalg.norm(direction, axis=1, keepdims=True)
    centres = centre + rng.uniform(-0.7, 0.7, (6, 3)) * (high - low)
    which = rng.integers(6, size=count)
    return centres[which] + rng.uniform(0.05, 0.15, 6)[which, None] * diagonal * rng.normal(size=(count, 3))


@pytest.mark.parametrize("pattern", ["gradient", "two parts", "twelve parts", "near scanner"])
@pytest.mark.parametrize("kind", ["mug", "table", "vase", "quadruped", "tree"])
def test_an_unevenly_sampled_surface_loses_nothing(kind, pattern):
    assert outlier_mask(unevenly_sampled(kind, pattern)).mean() < 0.01


@pytest.mark.parametrize("pattern", ["gradient", "two parts"])
def test_more_points_of_an_unevenly_sampled_surface_stay_too(pattern):
    for kind in ("mug", "vase"):
        assert outlier_mask(unevenly_sampled(kind, pattern, 4_000)).mean() < 0.01


def test_a_scan_whose_density_falls_with_distance_loses_nothing():
    for kind in ("car", "teapot", "chair"):
        points = densely_sampled(kind)[:5_000]
        viewpoint = points.mean(axis=0) + 0.5 * np.ptp(points, axis=0)
        seen = scan(points, viewpoint=viewpoint)[0]
        density = np.linalg.norm(seen - viewpoint, axis=1) ** -3.0
        rows = np.random.default_rng(0).choice(len(seen), len(seen) // 2, replace=False, p=density / density.sum())
        assert outlier_mask(seen[rows]).mean() < 0.01


@pytest.mark.parametrize("num_on_faces", [100, 300])
def test_large_faces_beside_fine_details_are_not_isolated(rng, num_on_faces):
    # a box whose points are vertices or drawn by triangles: nearly all of them are on a small knob
    box = rng.uniform(-1, 1, (num_on_faces, 3))
    axis = rng.integers(3, size=num_on_faces)
    box[np.arange(num_on_faces), axis] = np.sign(box[np.arange(num_on_faces), axis])
    knob = rng.normal(size=(3_000, 3))
    knob = [0, 0, 1] + 0.02 * knob / np.linalg.norm(knob, axis=1, keepdims=True)
    points = np.concatenate([box, knob])
    assert outlier_mask(points).mean() < 0.01
    # nor does a sparse surface keep a speck far beyond it
    dropped = outlier_mask(np.concatenate([points, [[500.0, 0, 0]]]))
    assert dropped[-1]
    assert dropped[:-1].mean() < 0.01


@pytest.mark.parametrize("alpha", [0.6, 1.0])
@pytest.mark.parametrize("how", STREWN)
def test_outliers_go_however_they_are_strewn(how, alpha):
    for kind in ("chair", "quadruped"):
        surface = densely_sampled(kind)[:NUM]
        dropped = outlier_mask(np.concatenate([surface, strewn(surface, how, int(alpha * NUM))]))
        assert dropped[NUM:].mean() > 0.7
        assert dropped[:NUM].mean() < 0.1


def test_few_isolated_outliers_go(rng):
    surface = densely_sampled("mug")[:NUM]
    diagonal = np.linalg.norm(np.ptp(surface, axis=0))
    for count in (1, 5, 20, 150):
        far = surface.mean(axis=0) + 5 * diagonal * rng.uniform(-1, 1, (count, 3))
        dropped = outlier_mask(np.concatenate([surface, far]))
        assert dropped[NUM:].mean() > 0.95
        assert not dropped[:NUM].any()


def test_the_sparse_part_of_a_surface_stays_when_outliers_go():
    surface = unevenly_sampled("quadruped", "two parts", 2_000)
    dropped = outlier_mask(np.concatenate([surface, strewn(surface, "shell", 1_000)]))
    assert dropped[2_000:].mean() > 0.9
    assert dropped[:2_000].mean() < 0.05


@pytest.mark.parametrize("how", STREWN)
def test_strewn_points_bound_no_voids(how):
    for count in (500, 4_000):
        points = strewn(densely_sampled("mug"), how, count)
        assert 0.75 < void_radius(points, np.arange(count)) < MIN_VOID - 0.1


@pytest.mark.parametrize("kind", ["ball", "drum", "table", "human", "spectacles", "vase"])
def test_surfaces_bound_voids_however_few_their_points(kind):
    for count in (500, 4_000):
        assert void_radius(densely_sampled(kind)[:count], np.arange(count)) > MIN_VOID


def test_the_void_beside_a_plane_ends_where_the_neighbours_end(rng):
    plane = np.c_[rng.uniform(size=(5_000, 2)), np.zeros(5_000)]
    # of the 48th neighbour and the 6th; the lower quartile of the ratio is a little less
    assert void_radius(plane, np.arange(5_000)) == pytest.approx(8**0.5, rel=0.2)


def test_no_note_says_that_a_clean_cloud_has_outliers():
    cloud = prepare(unevenly_sampled("vase", "gradient"), drop_outliers=True)
    assert not cloud.cleaned
    assert not any("outliers" in note for note in cloud.notes)
