"""A voxel grid around the cloud: every voxel holds its nearest surface point, so that neighbours are looked up."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt

from symjax.robust.surface import Surface
from symjax.robust.visibility import Viewpoint

SIZE = 64
"""Voxels along every side: a voxel is then about as wide as 5 000 points are apart."""

MARGIN = 0.1
"""Room around the cloud on every side, as a share of its longest side: what falls beyond is far from everything."""


class VoxelGrid(NamedTuple):
    """Voxels of a cube around the cloud, flattened.

    Attributes:
        origin: corner of the cube.
        cell: side of a voxel.
        point: the surface point nearest to each voxel's middle.
        normal: its normal.
        penalty: non-match penalty, 0 to 1: how much a point counts against a plane that mirrors it into this voxel,
            where it finds no partner.
    """

    origin: Float[np.ndarray, " 3"]
    cell: Float[np.ndarray, ""]
    point: Float[np.ndarray, "c 3"]
    normal: Float[np.ndarray, "c 3"]
    penalty: Float[np.ndarray, " c"]


def voxel_grid(surface: Surface, viewpoint: Viewpoint | None, *, boundary_penalty: float) -> VoxelGrid:
    """The voxel grid around a surface, in single precision.

    Args:
        surface: in any units.
        viewpoint: where it was scanned from, if from one side.
        boundary_penalty: non-match penalty of the voxels whose nearest point is on the boundary, if there is no
            viewpoint.
    """
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    side = (1 + 2 * MARGIN) * float((high - low).max())
    origin, cell = 0.5 * (low + high) - 0.5 * side, side / SIZE
    at = np.minimum(((surface.points - origin) / cell).astype(int), SIZE - 1)
    off_centre = (((surface.points - origin) / cell - at - 0.5) ** 2).sum(axis=1)
    row = np.zeros((SIZE, SIZE, SIZE), dtype=np.int32)
    empty = np.ones((SIZE, SIZE, SIZE), dtype=bool)
    # the last one written stays: the nearest to the middle
    order = np.argsort(-off_centre, kind="stable")
    row[tuple(at[order].T)] = order
    empty[tuple(at.T)] = False
    nearest = distance_transform_edt(empty, return_distances=False, return_indices=True)
    row = row[tuple(nearest)].ravel()
    if viewpoint is None:
        penalty = np.where(surface.boundary & ~np.array(surface.flat), boundary_penalty, 1.0)[row]
    else:
        penalty = viewpoint.penalty(_middles(origin, cell))
    return VoxelGrid(
        origin.astype(np.float32),
        np.asarray(cell, dtype=np.float32),
        surface.points.astype(np.float32)[row],
        surface.normals.astype(np.float32)[row],
        penalty.astype(np.float32),
    )


def _middles(origin: Float[np.ndarray, " 3"], cell: float) -> Float[np.ndarray, "c 3"]:
    along = [origin[i] + cell * (np.arange(SIZE) + 0.5) for i in range(3)]
    return np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)


def penalty_at(grid: VoxelGrid, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
    """Non-match penalty of the voxels that points lie in."""
    at = np.clip(((points - grid.origin) / grid.cell).astype(int), 0, SIZE - 1)
    return grid.penalty[(at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]]
