"""Slices, scan lines and thick voxels are recognised and sampled evenly; random samples of surfaces lose nothing."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from symjax.datasets import build, corrupt, generate, pose
from symjax.preprocess.cloud import prepare
from symjax.preprocess.layers import SUBSET, find_layers, layered_subset
from tests.helpers.layers import diagonal, sliced, voxels

OBLIQUE = np.array([0.3, 0.5, 0.8])

LINES = {
    "slices": {},
    "uneven slices": {"jitter": 0.3},
    "curved lines": {"bend": 0.03},
    "thick lines": {"noise": 0.05},
}


@pytest.mark.parametrize("style", LINES)
@pytest.mark.parametrize("kind", ["quadruped", "chair", "head"])
def test_lines_are_found_with_their_gap(kind, style):
    points = sliced(kind, 1 / 30, OBLIQUE, **LINES[style])
    layers = find_layers(points)
    assert 0.7 < layers.gap / (diagonal(kind) / 30) < 1.6  # wider where the surface slants


def test_parallel_planes_are_found_with_their_normal_and_gap():
    turn = Rotation.from_rotvec([0.2, 0.3, 0.1]).as_matrix()
    layers = find_layers(voxels("quadruped", (1 / 120, 1 / 120, 1 / 30), turn=turn))
    assert layers.are_planes
    assert abs(layers.normal @ turn[2]) == pytest.approx(1)
    assert layers.gap == pytest.approx(diagonal("quadruped") / 30)


def test_elongated_voxels_are_found():
    assert find_layers(voxels("quadruped", (1 / 120, 1 / 30, 1 / 30))) is not None


def test_isotropic_voxels_are_no_layers():
    assert find_layers(voxels("quadruped", (1 / 60, 1 / 60, 1 / 60))) is None


@pytest.mark.parametrize("kind", ["bicycle", "insect", "mug", "block", "ring", "table", "spectacles"])
@pytest.mark.parametrize(
    "corruption", [{}, {"noise": 0.01}, {"outliers": 1.0}, {"missing": 0.4}, {"one_sided": True}], ids=str
)
def test_random_samples_of_surfaces_are_no_layers(kind, corruption):
    points = corrupt(pose(generate(kind, num_points=2_000, rng=2), 2).points, 2, **corruption).points
    rows, layers = layered_subset(points)
    assert layers is None
    assert len(rows) == len(points)


def test_layers_too_far_apart_for_a_subset_are_kept_and_said():
    points = sliced("quadruped", 1 / 6, OBLIQUE)
    cloud = prepare(points)
    assert len(cloud.rows) == len(points)
    assert any("more were used" in note for note in cloud.notes)


def test_a_flat_grid_is_no_stack_of_layers(rng):
    grid = np.stack(np.meshgrid(np.arange(40.0), np.arange(30.0), [0.0, 5.0], indexing="ij"), axis=-1)
    assert find_layers(grid.reshape(-1, 3)) is None


def test_a_subset_of_layers_samples_the_surface_evenly():
    points = sliced("quadruped", 1 / 30, OBLIQUE)
    rows, layers = layered_subset(points)
    nearest = cKDTree(points[rows]).query(points[rows], k=2)[0][:, 1]
    assert nearest.min() > SUBSET * layers.gap * 0.99
    assert find_layers(points[rows]) is None
    assert layers.num_apart == len(rows)
    # no place on the layers is far from the subset
    assert cKDTree(points[rows]).query(points)[0].max() <= SUBSET * layers.gap


def test_a_cloud_says_that_it_was_sampled_on_layers():
    points = sliced("quadruped", 1 / 30, OBLIQUE)
    cloud = prepare(points)
    assert len(cloud.points) == len(cloud.rows) == cloud.layers.num_apart < len(points)
    assert any(f"{len(cloud.rows)} of the points, evenly spread over the surface" in note for note in cloud.notes)
    assert cloud.layers.gap * cloud.diagonal == pytest.approx(find_layers(points).gap, rel=0.2)


def test_normals_of_layers_follow_their_points():
    points = sliced("quadruped", 1 / 30, OBLIQUE)
    cloud = prepare(points, normals=points - points.mean(axis=0) + 1e-3)
    given = cloud.to_given.directions(cloud.normals)
    assert np.allclose(given, (points - points.mean(axis=0) + 1e-3)[cloud.rows])


def test_only_the_outlines_of_filled_layers_are_used():
    """All of the rest lies up to a gap below the surface."""
    points = voxels("head", (1 / 150, 1 / 150, 1 / 25))
    rows, layers = layered_subset(points)
    below = np.abs(build("head", np.random.default_rng(1)).field(points.T)) / layers.gap
    assert np.quantile(below, 0.9) > 0.4
    assert np.quantile(below[rows], 0.9) < 0.25


def test_outlines_within_outlines_are_kept():
    """The inner wall of a vessel is no step between layers."""
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    walls = np.concatenate([ring, 0.6 * ring])
    points = np.concatenate([np.column_stack([walls, np.full(400, height)]) for height in np.arange(0, 2, 0.2)])
    rows, layers = layered_subset(points)
    assert layers.are_planes
    assert np.mean(np.linalg.norm(points[rows, :2], axis=1) < 0.7) == pytest.approx(0.6 / 1.6, abs=0.05)


def test_too_few_points_are_no_layers(rng):
    assert find_layers(rng.normal(size=(40, 3))) is None
