"""A lattice around the cloud whose cells know the nearest surface: a search for neighbours becomes a look-up."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt

from symjax.robust.surface import Surface
from symjax.robust.visibility import Viewpoint

SIZE = 64
"""Cells along every side: a cell is then about as wide as 5 000 points are apart."""

MARGIN = 0.1
"""Room around the cloud on every side, as a share of its longest side: what falls beyond is far from everything."""

BEYOND_RIM = 0.15
"""Blame for having no partner where the surface ends: what was not scanned speaks neither for nor against."""


class Lattice(NamedTuple):
    """Cells of a cube around the cloud, flattened.

    Attributes:
        origin: corner of the cube.
        cell: side of a cell.
        point: the surface point nearest to each cell's middle.
        normal: its normal.
        blame: how much it tells against a plane that a point is mirrored into this cell and finds no partner, 0 to 1.
    """

    origin: Float[np.ndarray, "3"]
    cell: Float[np.ndarray, ""]
    point: Float[np.ndarray, "c 3"]
    normal: Float[np.ndarray, "c 3"]
    blame: Float[np.ndarray, "c"]


def lattice(surface: Surface, viewpoint: Viewpoint | None) -> Lattice:
    """The lattice around a surface, in single precision.

    Args:
        surface: in any units.
        viewpoint: where it was scanned from, if from one side.
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
        blame = np.where(surface.rim & ~np.array(surface.flat), BEYOND_RIM, 1.0)[row]
    else:
        blame = viewpoint.blame(_middles(origin, cell))
    return Lattice(
        origin.astype(np.float32),
        np.asarray(cell, dtype=np.float32),
        surface.points.astype(np.float32)[row],
        surface.normals.astype(np.float32)[row],
        blame.astype(np.float32),
    )


def _middles(origin: Float[np.ndarray, "3"], cell: float) -> Float[np.ndarray, "c 3"]:
    along = [origin[i] + cell * (np.arange(SIZE) + 0.5) for i in range(3)]
    return np.stack(np.meshgrid(*along, indexing="ij"), axis=-1).reshape(-1, 3)


def blame_at(lattice: Lattice, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n"]:
    """Blame of the cells that points are in."""
    at = np.clip(((points - lattice.origin) / lattice.cell).astype(int), 0, SIZE - 1)
    return lattice.blame[(at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]]
