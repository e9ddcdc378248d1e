"""The ground plane that an object stands on is removed, and the object is kept."""

import numpy as np
import pytest

from symjax.datasets import add_noise, add_outliers, generate
from symjax.datasets.sample import random_orthogonal
from symjax.preprocess.ground import ground_mask

OBJECT, GROUND, OUTLIER = range(3)
STANDING = ("chair", "desk", "car", "quadruped", "human", "head", "mug", "teapot", "cube", "pyramid", "bowl", "tree")
COMPLETE = (*STANDING, "block", "table", "sofa", "stool", "boat", "guitar", "prism", "drum", "vase", "ball", "spring")


class Scene:
    """An object on a square ground plane, scanned from above and so without its sole; random pose, units and shift."""

    def __init__(self, kind, rng, *, num_points=3000, width=1.6, share=0.6, seen=-1.0, noise=0.0, outliers=0.0):
        points = generate(kind, num_points=num_points, rng=rng).points
        points = points - [0, 0, points[:, 2].min()]
        size = np.linalg.norm(np.ptp(points, axis=0))
        across = points[:, :2]
        reach = width * np.ptp(across, axis=0).max() / 2
        ground = rng.uniform(-1, 1, size=(int(share * num_points), 3)) * [1, 1, 0]
        ground = ground[ground[:, 0] > seen] * reach
        ground[:, :2] += (across.min(axis=0) + across.max(axis=0)) / 2
        points = points[points[:, 2] > 0.005 * size]
        whole = add_noise(np.vstack([points, ground]), noise, rng)
        turn, self.unit = random_orthogonal(rng), 10.0 ** rng.uniform(-3, 6)
        shift = rng.normal(scale=size, size=3)
        scene = add_outliers(whole @ turn.T, outliers, rng)
        what = np.repeat([OBJECT, GROUND, OUTLIER], [len(points), len(ground), len(scene) - len(whole)])
        height = np.r_[whole[:, 2], np.full(len(scene) - len(whole), np.nan)] / size
        order = rng.permutation(len(scene))
        self.points, self.what, self.height = self.unit * (scene + shift)[order], what[order], height[order]
        self.size = self.unit * size

    def removed(self, found):
        return found[self.what == GROUND].mean()

    def kept(self, found, above=0.0):
        return 1 - found[(self.what == OBJECT) & (self.height > above)].mean()


@pytest.mark.parametrize("kind", STANDING)
def test_the_ground_plane_is_removed_and_the_object_is_kept(kind, rng):
    for num_points in (1000, 3000):
        scene = Scene(kind, rng, num_points=num_points)
        found = ground_mask(scene.points)
        assert scene.removed(found) >= 0.95
        assert scene.kept(found) >= 0.99
        assert found.dtype == bool
        assert found.shape == (len(scene.points),)


@pytest.mark.parametrize("kind", STANDING)
def test_noise_only_thickens_the_ground_plane(kind, rng):
    scene = Scene(kind, rng, noise=0.005, width=1.8)
    found = ground_mask(scene.points)
    assert scene.removed(found) >= 0.95
    # three standard deviations of the noise, which is relative to the diagonal of the whole scene
    assert scene.kept(found, above=0.07) >= 0.98


@pytest.mark.parametrize("outliers", [0.1, 1.0])
def test_outliers_on_both_sides_hide_neither_ground_plane_nor_object(outliers, rng):
    for kind in STANDING:
        scene = Scene(kind, rng, outliers=outliers, width=1.8, share=0.8)
        found = ground_mask(scene.points)
        assert scene.removed(found) >= 0.95
        assert scene.kept(found, above=0.05) >= 0.97


@pytest.mark.parametrize("kind", ["chair", "car", "human", "head", "mug"])
def test_a_ground_plane_visible_on_one_side_only_is_found(kind, rng):
    scene = Scene(kind, rng, seen=-0.2, width=1.8)
    found = ground_mask(scene.points)
    assert scene.removed(found) >= 0.95
    assert scene.kept(found) >= 0.99


def test_a_ground_plane_may_be_most_of_the_cloud(rng):
    scene = Scene("chair", rng, num_points=2000, share=9, width=4)
    found = ground_mask(scene.points)
    assert scene.removed(found) >= 0.99
    assert scene.kept(found) >= 0.99


@pytest.mark.parametrize("kind", COMPLETE)
def test_a_complete_object_has_no_ground_plane(kind, rng):
    for seed in range(2):
        points = generate(kind, num_points=3000, rng=seed).points @ random_orthogonal(rng).T
        assert not ground_mask(points).any()


@pytest.mark.parametrize(("noise", "outliers"), [(0.01, 0.0), (0.0, 1.0), (0.005, 0.5)])
def test_noise_and_outliers_are_rarely_classified_as_a_ground_plane(noise, outliers, rng):
    found = []
    for kind in COMPLETE:
        points = add_noise(generate(kind, num_points=2500, rng=rng).points @ random_orthogonal(rng).T, noise, rng)
        found.append(ground_mask(add_outliers(points, outliers, rng)))
    assert sum(ground.any() for ground in found) <= 1


def test_the_result_is_deterministic_and_barely_depends_on_the_seed(rng):
    scene = Scene("teapot", rng, noise=0.003)
    found = ground_mask(scene.points, seed=1)
    np.testing.assert_array_equal(ground_mask(scene.points, seed=1), found)
    assert (ground_mask(scene.points, seed=2) == found).mean() > 0.95


@pytest.mark.parametrize("noise", [0.0, 0.003])
def test_the_ground_plane_is_equivariant(noise, rng):
    for kind in ("chair", "mug", "head"):
        scene = Scene(kind, rng, noise=noise)
        found = ground_mask(scene.points)
        turn, move = random_orthogonal(rng), scene.size * rng.normal(size=3)
        there = ground_mask(7 * scene.points @ turn.T + move)
        assert (there != found).mean() < 0.005


def test_clouds_without_an_object_have_no_ground_plane(rng):
    plate = rng.uniform(size=(2000, 3)) * [1, 1, 0]
    for points in (plate, plate + rng.normal(scale=0.01, size=plate.shape), np.outer(plate[:, 0], [1.0, 2.0, 3.0])):
        assert not ground_mask(points).any()
    assert not ground_mask(np.ones((100, 3))).any()
    assert not ground_mask(np.repeat(plate[:4], 100, axis=0)).any()
    assert not ground_mask(plate[:20]).any()
    assert not ground_mask(rng.normal(size=(2000, 3))).any()
