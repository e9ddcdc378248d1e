"""The lattice's look-up against an exact search, and its blame."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from symjax.datasets import generate, remove_part
from symjax.robust.surface import surface
from symjax.robust.visibility import Viewpoint
from symjax.robust.voxel_grid import BEYOND_RIM, MARGIN, SIZE, blame_at, lattice


@pytest.fixture(scope="module")
def around():
    return surface(remove_part(generate("quadruped", num_points=2_000, rng=0).points, 0.2, 1)[0])


@pytest.fixture(scope="module")
def cells(around):
    return lattice(around, None)


@pytest.fixture(scope="module")
def middles(cells):
    index = np.stack(np.unravel_index(np.arange(SIZE**3), (SIZE, SIZE, SIZE)), axis=1)
    return cells.origin + float(cells.cell) * (index + 0.5)


def a_scan():
    """A viewpoint far above that saw a disc of radius 0.5 at height 0."""
    depth = np.full((40, 40), np.inf)
    x, y = np.meshgrid(*2 * [(np.arange(40) + 0.5) * 0.1 - 2], indexing="ij")
    depth[np.hypot(x, y) < 0.5] = 1e3
    return Viewpoint(np.array([0.0, 0.0, 1.0]), np.zeros(3), 1e3, 0.1, np.array([-2.0, -2.0]), depth)


def test_the_point_of_every_cell_is_the_nearest_up_to_the_cells_diagonal(around, cells, middles):
    exact = cKDTree(around.points).query(middles)[0]
    found = np.linalg.norm(cells.point - middles, axis=1)
    assert (found - exact).max() < np.sqrt(3) * cells.cell + 1e-5
    assert (found - exact).min() > -1e-5
    # most are the nearest indeed, or nearly so
    assert np.quantile(found - exact, 0.9) < 0.5 * cells.cell


def test_a_point_of_the_surface_finds_itself_or_one_in_its_cell(around, cells):
    at = np.floor((around.points - cells.origin) / cells.cell).astype(int)
    theirs = cells.point[(at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]]
    np.testing.assert_array_equal(np.floor((theirs - cells.origin) / cells.cell).astype(int), at)
    assert np.linalg.norm(theirs - around.points, axis=1).max() <= np.sqrt(3) * cells.cell


def test_of_several_points_in_a_cell_the_nearest_to_its_middle_stays(rng):
    points = generate("quadruped", num_points=200, rng=0).points
    extra = points[::10] + 1e-3 * rng.normal(size=(20, 3))
    around = surface(np.vstack([points, extra]))
    cells = lattice(around, None)
    at = np.floor((around.points - cells.origin) / cells.cell).astype(int)
    middle = cells.origin + cells.cell * (at + 0.5)
    keys = (at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]
    shared = [key for key in np.unique(keys) if np.count_nonzero(keys == key) > 1]
    assert len(shared) > 5
    for key in shared:
        rows = np.flatnonzero(keys == key)
        best = rows[np.argmin(np.linalg.norm(around.points[rows] - middle[rows], axis=1))]
        np.testing.assert_allclose(cells.point[key], around.points[best], atol=1e-6)


def test_every_cells_normal_is_its_points(around, cells):
    row = cKDTree(around.points.astype(np.float32)).query(cells.point[::97])[1]
    np.testing.assert_array_equal(cells.normal[::97], around.normals[row].astype(np.float32))


def test_the_lattice_is_a_cube_with_a_margin_in_single_precision(around, cells):
    low, high = around.points.min(axis=0), around.points.max(axis=0)
    side = SIZE * float(cells.cell)
    assert side == pytest.approx((1 + 2 * MARGIN) * (high - low).max(), rel=1e-5)
    np.testing.assert_allclose(cells.origin + side / 2, 0.5 * (low + high), atol=1e-5)
    assert {leaf.dtype for leaf in cells} == {np.dtype(np.float32)}
    assert cells.point.shape == cells.normal.shape == (SIZE**3, 3)


def test_without_a_viewpoint_only_the_rim_is_blamed_less(around, cells):
    assert around.rim.any()
    np.testing.assert_array_equal(np.unique(cells.blame), np.float32([BEYOND_RIM, 1.0]))
    row = cKDTree(around.points.astype(np.float32)).query(cells.point)[1]
    np.testing.assert_array_equal(cells.blame == 1.0, ~around.rim[row])


def test_with_a_viewpoint_the_blame_is_what_it_saw_at_the_cells_middles(around, middles):
    seen = a_scan()
    found = lattice(around, seen).blame
    np.testing.assert_array_equal(found, seen.blame(middles).astype(np.float32))
    assert len(np.unique(found)) == 3


def test_blame_is_looked_up_in_the_cell_a_point_is_in(around, middles, rng):
    cells = lattice(around, a_scan())
    np.testing.assert_array_equal(blame_at(cells, middles), cells.blame)
    inside = middles + 0.45 * float(cells.cell) * rng.uniform(-1, 1, size=middles.shape)
    np.testing.assert_array_equal(blame_at(cells, inside), cells.blame)


def test_points_outside_get_the_nearest_border_cell(around, middles, rng):
    cells = lattice(around, a_scan())
    points = rng.uniform(-1, 1, size=(3_000, 3)) * 5
    low, high = middles.min(axis=0), middles.max(axis=0)
    np.testing.assert_array_equal(blame_at(cells, points), blame_at(cells, np.clip(points, low, high)))
    just_outside = middles[:1] - 0.9 * float(cells.cell)
    assert blame_at(cells, just_outside) == cells.blame[0]


def test_the_lattice_grows_and_moves_with_the_cloud(around, cells):
    other = lattice(surface(4 * around.points + 10), None)
    assert other.cell == pytest.approx(4 * cells.cell, rel=1e-5)
    moved = 4 * cells.point + 10
    assert np.mean(np.abs(other.point - moved).max(axis=1) < 1e-4) > 0.999


def test_a_flat_cloud_has_a_lattice(rng):
    flat = np.c_[rng.uniform(size=(500, 2)), np.zeros(500)]
    cells = lattice(surface(flat), None)
    assert np.isfinite(cells.point).all()
    assert (cells.point[:, 2] == 0).all()
