"""The rectangle of a plane that lies in the object: the benchmark of Funk et al. compares the middles of two.

A file gives three corners. In what the organisers' writer wrote, the first is next to both others, so that the middle
is (p_b + p_c)/2; (p_a + p_c)/2, as the paper prints, is the middle of an edge.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane


class Patches(NamedTuple):
    """Rectangles of planes.

    Attributes:
        normals: unit normals.
        centres: their middles.
        sides: the shorter side of each.
    """

    normals: Float[np.ndarray, "k 3"]
    centres: Float[np.ndarray, "k 3"]
    sides: Float[np.ndarray, " k"]


def from_corners(corners: Float[np.ndarray, "k 3 3"], *, as_printed: bool = False) -> Patches:
    """Rectangles of a file.

    Args:
        corners: p_a, p_b, p_c of every plane, not on one line.
        as_printed: take the paper's centre (p_a + p_c)/2.
    """
    a, b, c = corners.swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    sides = np.minimum(np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1))
    centres = (a + c) / 2 if as_printed else (b + c) / 2
    return Patches(normals / np.linalg.norm(normals, axis=1, keepdims=True), centres, sides)


def bounding(planes: Plane, points: Float[np.ndarray, "n 3"]) -> Patches:
    """The rectangles that bound the projections of all points, for planes that are given without one.

    As the organisers' writer places them: one side along the projection of z on the plane, or of x where that is
    short. It bounds the inliers, and its axes are not of unit length; both are put right here.
    """
    normals, offsets = map(np.asarray, planes)
    centres, sides = np.empty_like(normals), np.empty(len(normals))
    for k, normal in enumerate(normals):
        z = np.array([0.0, 0.0, 1.0])
        up = z - (normal @ z) * normal
        if np.linalg.norm(up) < 0.01:
            up = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
        up /= np.linalg.norm(up)
        axes = np.stack([np.cross(normal, up), up])
        along = points @ axes.T
        low, high = along.min(axis=0), along.max(axis=0)
        centres[k] = (low + high) / 2 @ axes + offsets[k] * normal
        sides[k] = (high - low).min()
    return Patches(normals, centres, sides)
