"""A polygon mesh as it came from a file, and points sampled from its surface."""

from array import array
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import FileFormatError
from symjax.io import parsing


class Mesh(NamedTuple):
    """Vertices and triangles; a file without faces has no triangles and is a point cloud."""

    vertices: Float[np.ndarray, "v 3"]
    triangles: Int[np.ndarray, "t 3"]
    num_faces: int
    """Polygons in the file, before they were cut into triangles."""
    num_parts: int = 1
    """Objects, groups or solids with faces of their own; they are merged."""


class Polygons(NamedTuple):
    """How many corners each polygon has, and the vertex indices of all corners, one polygon after another."""

    sizes: Int[np.ndarray, " f"]
    corners: Int[np.ndarray, " c"]


NO_POLYGONS = Polygons(np.empty(0, np.int64), np.empty(0, np.int64))


def parse_polygons(rows: list[str], before: int = 0) -> Polygons:
    """Polygons written as "3 0 1 2", after `before` other numbers and followed by anything."""
    sizes, corners = array("q"), array("q")
    for number, row in enumerate(rows, start=1):
        try:
            cells = row.split()
            size = int(cells[before])
            indices = list(map(int, cells[before + 1 : before + 1 + size]))
            corners.extend(indices)
        except (ValueError, IndexError, OverflowError):
            indices, size = [], -1
        if len(indices) != size:
            raise FileFormatError(f"face {number} is {parsing.shown(row)}: a count and as many vertex indices expected")
        sizes.append(size)
    return Polygons(np.array(sizes, np.int64), np.array(corners, np.int64))


def from_polygons(vertices: Float[np.ndarray, "v 3"], polygons: Polygons, num_parts: int = 1) -> Mesh:
    """Cut polygons into triangle fans.

    Raises:
        FileFormatError: a polygon of fewer than 3 corners, or a corner that is no vertex.
    """
    sizes, corners = polygons
    if len(sizes) and sizes.min() < 3:
        first = int(np.argmax(sizes < 3))
        raise FileFormatError(f"face {first} has {sizes[first]} corners: at least 3 expected")
    is_outside = (corners < 0) | (corners >= len(vertices))
    if is_outside.any():
        first = corners[np.argmax(is_outside)]
        raise FileFormatError(
            f"{is_outside.sum()} face corners are no vertex of the {len(vertices)} in the file (first: {first})"
        )
    fans = sizes - 2
    start = np.repeat(np.cumsum(sizes) - sizes, fans)
    step = np.arange(fans.sum()) - np.repeat(np.cumsum(fans) - fans, fans)
    triangles = np.stack([corners[start], corners[start + step + 1], corners[start + step + 2]], axis=1)
    return Mesh(vertices, triangles, len(sizes), num_parts)


def sample(mesh: Mesh, num_points: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Points uniform by area on the surface: a triangle by its area, then a uniform point in it (Osada et al. 2002).

    Raises:
        FileFormatError: a vertex of a face is not finite, or no face has any area.
    """
    used = mesh.vertices[mesh.triangles]
    if not np.isfinite(used).all():
        raise FileFormatError("faces with NaN or infinite vertices")
    # unit size first: the areas of a mesh in units of 1e±200 would over- or underflow
    low, high = used.min(axis=(0, 1)), used.max(axis=(0, 1))
    with np.errstate(over="ignore"):
        size = float((high - low).max())
    if not 0 < size < np.inf:
        raise FileFormatError("faces without any area")
    unit = (used - low) / size
    edges = unit[:, 1:] - unit[:, :1]
    cumulative = np.cumsum(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1))
    if not cumulative[-1] > 0:
        raise FileFormatError("faces without any area")
    index = np.searchsorted(cumulative, rng.random(num_points) * cumulative[-1], side="right")
    root, along = np.sqrt(rng.random(num_points)), rng.random(num_points)
    weights = np.stack([1 - root, root * (1 - along), root * along], axis=1)
    return low + size * np.einsum("nk,nkd->nd", weights, unit[index])
