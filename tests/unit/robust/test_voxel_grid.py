"""The look-up of the voxel grid, compared with an exact search, and its non-match penalty."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from symjax.datasets import generate, remove_part
from symjax.robust.surface import estimate_surface
from symjax.robust.visibility import Viewpoint
from symjax.robust.voxel_grid import MARGIN, SIZE, penalty_at, voxel_grid

BOUNDARY_PENALTY = 0.2


def grid_of(surface, viewpoint):
    return voxel_grid(surface, viewpoint, boundary_penalty=BOUNDARY_PENALTY)


@pytest.fixture(scope="module")
def around():
    return estimate_surface(remove_part(generate("quadruped", num_points=2_000, rng=0).points, 0.2, 1)[0])


@pytest.fixture(scope="module")
def grid(around):
    return grid_of(around, None)


@pytest.fixture(scope="module")
def centres(grid):
    index = np.stack(np.unravel_index(np.arange(SIZE**3), (SIZE, SIZE, SIZE)), axis=1)
    return grid.origin + float(grid.cell) * (index + 0.5)


def scan_viewpoint():
    """Returns a viewpoint far above whose depth image shows a disc of radius 0.5 at height 0."""
    depth = np.full((40, 40), np.inf)
    x, y = np.meshgrid(*2 * [(np.arange(40) + 0.5) * 0.1 - 2], indexing="ij")
    depth[np.hypot(x, y) < 0.5] = 1e3
    return Viewpoint(np.array([0.0, 0.0, 1.0]), np.zeros(3), 1e3, 0.1, np.array([-2.0, -2.0]), depth)


def test_the_point_of_every_voxel_is_the_nearest_up_to_the_diagonal_of_a_voxel(around, grid, centres):
    exact = cKDTree(around.points).query(centres)[0]
    found = np.linalg.norm(grid.point - centres, axis=1)
    assert (found - exact).max() < np.sqrt(3) * grid.cell + 1e-5
    assert (found - exact).min() > -1e-5
    # most of them are the nearest, or nearly so
    assert np.quantile(found - exact, 0.9) < 0.5 * grid.cell


def test_a_surface_point_finds_itself_or_another_in_its_voxel(around, grid):
    at = np.floor((around.points - grid.origin) / grid.cell).astype(int)
    theirs = grid.point[(at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]]
    np.testing.assert_array_equal(np.floor((theirs - grid.origin) / grid.cell).astype(int), at)
    assert np.linalg.norm(theirs - around.points, axis=1).max() <= np.sqrt(3) * grid.cell


def test_of_several_points_in_a_voxel_the_nearest_to_its_centre_is_stored(rng):
    points = generate("quadruped", num_points=200, rng=0).points
    extra = points[::10] + 1e-3 * rng.normal(size=(20, 3))
    around = estimate_surface(np.vstack([points, extra]))
    grid = grid_of(around, None)
    at = np.floor((around.points - grid.origin) / grid.cell).astype(int)
    centre = grid.origin + grid.cell * (at + 0.5)
    keys = (at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]
    shared = [key for key in np.unique(keys) if np.count_nonzero(keys == key) > 1]
    assert len(shared) > 5
    for key in shared:
        rows = np.flatnonzero(keys == key)
        best = rows[np.argmin(np.linalg.norm(around.points[rows] - centre[rows], axis=1))]
        np.testing.assert_allclose(grid.point[key], around.points[best], atol=1e-6)


def test_the_normal_of_every_voxel_is_that_of_its_point(around, grid):
    row = cKDTree(around.points.astype(np.float32)).query(grid.point[::97])[1]
    np.testing.assert_array_equal(grid.normal[::97], around.normals[row].astype(np.float32))


def test_the_grid_is_a_cube_with_a_margin_in_single_precision(around, grid):
    low, high = around.points.min(axis=0), around.points.max(axis=0)
    side = SIZE * float(grid.cell)
    assert side == pytest.approx((1 + 2 * MARGIN) * (high - low).max(), rel=1e-5)
    np.testing.assert_allclose(grid.origin + side / 2, 0.5 * (low + high), atol=1e-5)
    assert {leaf.dtype for leaf in grid} == {np.dtype(np.float32)}
    assert grid.point.shape == grid.normal.shape == (SIZE**3, 3)


def test_without_a_viewpoint_the_penalty_is_lower_at_the_boundary_only(around, grid):
    assert around.boundary.any()
    np.testing.assert_array_equal(np.unique(grid.penalty), np.float32([BOUNDARY_PENALTY, 1.0]))
    row = cKDTree(around.points.astype(np.float32)).query(grid.point)[1]
    np.testing.assert_array_equal(grid.penalty == 1.0, ~around.boundary[row])


def test_with_a_viewpoint_the_penalty_is_that_of_its_depth_image(around, centres):
    seen = scan_viewpoint()
    found = grid_of(around, seen).penalty
    np.testing.assert_array_equal(found, seen.penalty(centres).astype(np.float32))
    assert len(np.unique(found)) == 3


def test_the_penalty_at_a_point_is_that_of_its_voxel(around, centres, rng):
    grid = grid_of(around, scan_viewpoint())
    np.testing.assert_array_equal(penalty_at(grid, centres), grid.penalty)
    inside = centres + 0.45 * float(grid.cell) * rng.uniform(-1, 1, size=centres.shape)
    np.testing.assert_array_equal(penalty_at(grid, inside), grid.penalty)


def test_the_penalty_at_a_point_outside_is_that_of_the_nearest_voxel(around, centres, rng):
    grid = grid_of(around, scan_viewpoint())
    points = rng.uniform(-1, 1, size=(3_000, 3)) * 5
    low, high = centres.min(axis=0), centres.max(axis=0)
    np.testing.assert_array_equal(penalty_at(grid, points), penalty_at(grid, np.clip(points, low, high)))
    just_outside = centres[:1] - 0.9 * float(grid.cell)
    assert penalty_at(grid, just_outside) == grid.penalty[0]


def test_the_grid_is_equivariant_under_scaling_and_shifting(around, grid):
    other = grid_of(estimate_surface(4 * around.points + 10), None)
    assert other.cell == pytest.approx(4 * grid.cell, rel=1e-5)
    moved = 4 * grid.point + 10
    assert np.mean(np.abs(other.point - moved).max(axis=1) < 1e-4) > 0.999


def test_a_flat_cloud_has_a_grid(rng):
    flat = np.c_[rng.uniform(size=(500, 2)), np.zeros(500)]
    grid = grid_of(estimate_surface(flat), None)
    assert np.isfinite(grid.point).all()
    assert (grid.point[:, 2] == 0).all()
