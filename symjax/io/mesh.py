"""Polygon meshes from files, and points sampled from their surfaces."""

from array import array
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import FileFormatError
from symjax.io import parsing


class Mesh(NamedTuple):
    """A triangle mesh, or a point cloud if there are no triangles.

    Attributes:
        vertices: positions of the vertices, in the units of the file.
        triangles: vertex indices of each triangle.
        num_faces: number of polygons in the file, before triangulation.
        num_parts: number of objects, groups or solids with faces in the file. They are merged.
    """

    vertices: Float[np.ndarray, "v 3"]
    triangles: Int[np.ndarray, "t 3"]
    num_faces: int
    num_parts: int = 1


class Polygons(NamedTuple):
    """Faces of a mesh.

    Attributes:
        sizes: number of corners of each face.
        corners: vertex indices of the corners of all faces, one face after another.
    """

    sizes: Int[np.ndarray, " f"]
    corners: Int[np.ndarray, " c"]


NO_POLYGONS = Polygons(np.empty(0, np.int64), np.empty(0, np.int64))


def parse_polygons(rows: parsing.Rows, skip: int = 0) -> Polygons:
    """Parses faces in rows such as "3 0 1 2", a number of corners and their vertex indices.

    Args:
        rows: lines with one face each. Further columns are ignored.
        skip: number of columns before the number of corners.

    Raises:
        FileFormatError: if a row is not of this form.
    """
    sizes, corners = array("q"), array("q")
    for row, number in zip(rows.texts, rows.numbers, strict=True):
        try:
            cells = row.split()
            size = int(cells[skip])
            indices = list(map(int, cells[skip + 1 : skip + 1 + size]))
            corners.extend(indices)
        except (ValueError, IndexError, OverflowError):
            indices, size = [], -1
        if len(indices) != size:
            raise FileFormatError(
                f"line {number}: expected a number of corners and as many vertex indices, found {parsing.shown(row)}"
            )
        sizes.append(size)
    return Polygons(np.array(sizes, np.int64), np.array(corners, np.int64))


def from_polygons(
    vertices: Float[np.ndarray, "v 3"], polygons: Polygons, *, num_parts: int = 1, first_index: int = 0
) -> Mesh:
    """Triangulates polygons as fans.

    Args:
        vertices: positions of the vertices.
        polygons: faces, with vertex indices counted from 0.
        num_parts: number of parts in the file.
        first_index: index of the first vertex in the file format, for error messages.

    Raises:
        FileFormatError: if a face has fewer than 3 corners, or refers to a vertex that does not exist.
    """
    sizes, corners = polygons
    if len(sizes) and sizes.min() < 3:
        first = int(np.argmax(sizes < 3))
        raise FileFormatError(f"face {first + 1} of {len(sizes)} has {sizes[first]} corners: at least 3 are needed")
    is_outside = (corners < 0) | (corners >= len(vertices))
    if is_outside.any():
        first = int(np.argmax(is_outside))
        face = int(np.searchsorted(np.cumsum(sizes), first, side="right"))
        raise FileFormatError(
            f"face {face + 1} of {len(sizes)} refers to vertex {corners[first] + first_index}, but the number of "
            f"vertices, counted from {first_index}, is {len(vertices)}"
        )
    fans = sizes - 2
    start = np.repeat(np.cumsum(sizes) - sizes, fans)
    step = np.arange(fans.sum()) - np.repeat(np.cumsum(fans) - fans, fans)
    triangles = np.stack([corners[start], corners[start + step + 1], corners[start + step + 2]], axis=1)
    return Mesh(vertices, triangles, len(sizes), num_parts)


def sample(mesh: Mesh, num_points: int, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """Samples points uniformly by area from the surface of a mesh (Osada et al. 2002).

    Each point is uniform in a triangle, which is drawn with a probability proportional to its area.

    Args:
        mesh: mesh with at least one triangle.
        num_points: number of points.
        rng: generator of the random numbers.

    Raises:
        FileFormatError: if a vertex of a face is NaN or infinite, or all faces have zero area.
    """
    used = mesh.vertices[mesh.triangles]
    is_finite = np.isfinite(used).all(axis=2)
    if not is_finite.all():
        vertex = mesh.triangles[~is_finite][0]
        raise FileFormatError(f"vertex {vertex} (counted from 0) of a face is NaN or infinite: {mesh.vertices[vertex]}")
    # scaled to unit size, since the areas of a mesh in units of 1e±200 would over- or underflow
    low, high = used.min(axis=(0, 1)), used.max(axis=(0, 1))
    with np.errstate(over="ignore"):
        size = float((high - low).max())
    if not 0 < size < np.inf:
        raise FileFormatError("the faces have no area, so no points can be sampled from them")
    unit = (used - low) / size
    edges = unit[:, 1:] - unit[:, :1]
    cumulative = np.cumsum(np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1))
    if not cumulative[-1] > 0:
        raise FileFormatError("the faces have no area, so no points can be sampled from them")
    index = np.searchsorted(cumulative, rng.random(num_points) * cumulative[-1], side="right")
    root, along = np.sqrt(rng.random(num_points)), rng.random(num_points)
    weights = np.stack([1 - root, root * (1 - along), root * along], axis=1)
    points: Float[np.ndarray, "n 3"] = low + size * np.einsum("nk,nkd->nd", weights, unit[index])
    return points
