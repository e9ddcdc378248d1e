"""Squared distance of points from a triangle mesh, exactly.

`trimesh.proximity` would need a further library; its `closest_point` of one triangle does not. Which triangles are
worth asking: with q a point, c the centroid of a triangle and r its radius about c, |q − c| − r ≤ distance. The
distance from the triangle whose centroid is nearest bounds the least one from above, and a ball query finds all
triangles whose lower bound is not beyond it. Those of one octave of r are searched together, so that a large one does
not widen the search for all.
"""

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import KDTree
from trimesh.triangles import closest_point

from symjax.errors import InvalidArgumentError
from symjax.io.mesh import Mesh

FLAT = 1e-12
"""Height over longest edge below which a triangle counts as a segment and is left out: it has no area, its edges are
those of its neighbours, and the formula for the closest point divides by that area."""

POINTS = 64
"""Points searched at a time."""

PAIRS = 200_000
"""Pairs of point and triangle evaluated at a time: bounds the memory."""

SLACK = 1 + 1e-9
"""Widens the search by more than rounding."""


def squared_distances(points: Float[np.ndarray, "n 3"], mesh: Mesh) -> Float[np.ndarray, "n"]:
    """Squared distance of every point from the nearest triangle.

    Raises:
        InvalidArgumentError: the mesh has no triangle with an area.
    """
    corners = _with_area(mesh.vertices[mesh.triangles])
    if len(corners) == 0:
        raise InvalidArgumentError("distances from a mesh without any area: a cloud has no triangles")
    centres = corners.mean(axis=1)
    radii = np.linalg.norm(corners - centres[:, None], axis=2).max(axis=1)
    least = _to_triangles(points, corners[KDTree(centres).query(points)[1]])
    octaves = np.frexp(radii)[1]
    for octave in np.unique(octaves):
        members = np.flatnonzero(octaves == octave)
        tree = KDTree(centres[members])
        for start in range(0, len(points), POINTS):
            part = slice(start, start + POINTS)
            reach = SLACK * (np.sqrt(least[part]) + radii[members].max())
            near = tree.query_ball_point(points[part], reach)
            owner = start + np.repeat(np.arange(len(near)), [len(one) for one in near])
            _lower(least, points, corners, owner, members[np.concatenate([*near, []]).astype(int)])
    return least


def _with_area(corners: Float[np.ndarray, "t 3 3"]) -> Float[np.ndarray, "s 3 3"]:
    edges = corners - np.roll(corners, 1, axis=1)
    longest = np.linalg.norm(edges, axis=2).max(axis=1)
    twice_area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    return corners[twice_area > FLAT * longest**2]


def _lower(
    least: Float[np.ndarray, "n"],
    points: Float[np.ndarray, "n 3"],
    corners: Float[np.ndarray, "t 3 3"],
    owner: Int[np.ndarray, "p"],
    triangle: Int[np.ndarray, "p"],
) -> None:
    """Lowers, in place, the least distance of `owner[p]` to that from `triangle[p]` where this is less."""
    for start in range(0, len(owner), PAIRS):
        q, t = owner[start : start + PAIRS], triangle[start : start + PAIRS]
        np.minimum.at(least, q, _to_triangles(points[q], corners[t]))


def _to_triangles(points: Float[np.ndarray, "p 3"], corners: Float[np.ndarray, "p 3 3"]) -> Float[np.ndarray, "p"]:
    return ((closest_point(corners, points) - points) ** 2).sum(axis=1)
