"""Voxel grid: stores the nearest surface point of every voxel around the cloud, so that a look-up replaces a search."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt

from symjax.geometry.arrays import AnyArray
from symjax.robust.surface import Surface
from symjax.robust.visibility import Viewpoint

SIZE = 64
"""Voxels along every side. A voxel is then about as wide as the spacing of 5 000 points."""

MARGIN = 0.1
"""Margin around the cloud on every side, as a fraction of the longest. A point beyond it is far from the surface."""


class VoxelGrid(NamedTuple):
    """A cube of voxels around the cloud, flattened; arrays of NumPy, or of JAX once it is on a device.

    Attributes:
        origin: corner of the cube with the smallest coordinates.
        cell: side of a voxel.
        point: surface point nearest to the centre of each voxel.
        normal: surface normal at that point.
        penalty: non-match penalty of each voxel, 0 to 1: how strongly a mirror image in the voxel counts against a
            plane if it does not match the surface.
    """

    origin: Float[AnyArray, " 3"]
    cell: Float[AnyArray, ""]
    point: Float[AnyArray, "c 3"]
    normal: Float[AnyArray, "c 3"]
    penalty: Float[AnyArray, " c"]


def voxel_grid(surface: Surface, viewpoint: Viewpoint | None, *, boundary_penalty: float) -> VoxelGrid:
    """Builds the voxel grid around a surface, in single precision.

    Args:
        surface: the surface, in any units.
        viewpoint: the viewpoint of a scan from one side, which then decides the non-match penalty; None for any other
            cloud.
        boundary_penalty: non-match penalty of voxels whose nearest point lies on the boundary; it is 1 elsewhere. Not
            used if there is a viewpoint, or if the cloud is flat.

    Returns:
        The grid, with NumPy arrays.
    """
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    side = (1 + 2 * MARGIN) * float((high - low).max())
    origin, cell = 0.5 * (low + high) - 0.5 * side, side / SIZE
    voxel = np.minimum(((surface.points - origin) / cell).astype(int), SIZE - 1)
    squared_distance = (((surface.points - origin) / cell - voxel - 0.5) ** 2).sum(axis=1)
    row = np.zeros((SIZE, SIZE, SIZE), dtype=np.int32)
    empty = np.ones((SIZE, SIZE, SIZE), dtype=bool)
    # of several points in a voxel the last one written remains: the one nearest to its centre
    order = np.argsort(-squared_distance, kind="stable")
    row[tuple(voxel[order].T)] = order
    empty[tuple(voxel.T)] = False
    nearest = distance_transform_edt(empty, return_distances=False, return_indices=True)
    row = row[tuple(nearest)].ravel()
    if viewpoint is None:
        penalty = np.where(surface.boundary & ~np.array(surface.flat), boundary_penalty, 1.0)[row]
    else:
        penalty = viewpoint.penalty(_centres(origin, cell))
    return VoxelGrid(
        origin.astype(np.float32),
        np.asarray(cell, dtype=np.float32),
        surface.points.astype(np.float32)[row],
        surface.normals.astype(np.float32)[row],
        penalty.astype(np.float32),
    )


def _centres(origin: Float[np.ndarray, " 3"], cell: float) -> Float[np.ndarray, "c 3"]:
    """Returns the centre of every voxel."""
    along = [origin[i] + cell * (np.arange(SIZE) + 0.5) for i in range(3)]
    return np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)


def penalty_at(grid: VoxelGrid, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
    """Returns the non-match penalty at points: that of their voxel, or of the nearest one if they lie outside."""
    voxel = np.clip(((points - grid.origin) / grid.cell).astype(int), 0, SIZE - 1)
    index = (voxel[:, 0] * SIZE + voxel[:, 1]) * SIZE + voxel[:, 2]
    penalty: Float[np.ndarray, " n"] = np.asarray(grid.penalty)[index]
    return penalty
