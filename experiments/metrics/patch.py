"""Bounded rectangles of mirror planes: the benchmark of Funk et al. compares the centres of two rectangles.

A file gives three corners. In the files of the organisers, the first corner is adjacent to both others, so that the
centre is (p_b + p_c)/2; the formula printed in the paper, (p_a + p_c)/2, is the midpoint of an edge.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.geometry.plane import Plane


class Patches(NamedTuple):
    """Rectangles of planes.

    Attributes:
        normals: unit normals.
        centres: centres of the rectangles.
        sides: shorter side of each rectangle.
    """

    normals: Float[np.ndarray, "k 3"]
    centres: Float[np.ndarray, "k 3"]
    sides: Float[np.ndarray, " k"]


def from_corners(corners: Float[np.ndarray, "k 3 3"], *, as_printed: bool = False) -> Patches:
    """Builds rectangles from the corners in a file.

    Args:
        corners: p_a, p_b, p_c of every plane, not collinear.
        as_printed: use the centre printed in the paper, (p_a + p_c)/2.
    """
    a, b, c = corners.swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    sides = np.minimum(np.linalg.norm(b - a, axis=1), np.linalg.norm(c - a, axis=1))
    centres = (a + c) / 2 if as_printed else (b + c) / 2
    return Patches(normals / np.linalg.norm(normals, axis=1, keepdims=True), centres, sides)


def bounding(planes: Plane, points: Float[np.ndarray, "n 3"]) -> Patches:
    """Computes the rectangles that bound the projections of all points onto each plane.

    They are oriented as in the organisers' program: one side is along the projection of the z axis onto the plane, or
    of the x axis if that projection is short. The organisers' program bounds only the inliers and uses axes that are
    not of unit length; both are corrected here.
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
