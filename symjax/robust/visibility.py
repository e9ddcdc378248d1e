"""Scans from one side: where they were taken from, and where they saw that there is nothing.

In a scan from one side no point hides another one. That also holds when it is seen from behind, so the bulge of the
surface decides the side: what a scanner sees of a solid bulges towards the scanner.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import minimum_filter
from scipy.spatial import cKDTree

from symjax.geometry.directions import fibonacci
from symjax.geometry.local_frames import tangent_frames
from symjax.robust.surface import Surface

DISTANCE = 2.0
"""Distance of the viewpoint from the middle of the cloud in diagonals: where a scanner stands, a few object sizes off;
farther ones see almost the same."""

ONE_SIDED = 0.935
"""Share of the points that must be visible from one point. Measured: 0.948 to 1 on scans, 0.48 to 0.92 on whole and cut
objects."""

NUM_PROBES, NUM_DIRECTIONS, NUM_BEST = 800, 100, 4
"""Points and directions (over half the sphere; and their opposites) of the search, and the number of best directions
that are tried with all points: among few points one sees through thin parts."""

PIXEL = 2.0
"""Side of a pixel of the depth image in spacings: then hardly any is empty by chance."""

FINEST_PIXEL = 1 / 750
"""Least side of a pixel in diagonals. At DISTANCE the cloud's image is at most 4/3 diagonals wide, so that the
image has hardly more than 2²⁰ pixels, enough for four million even points. Where one spot is far denser than the rest,
the spacing is that of the spot, and pixels of its size would need any amount of memory."""

NEAR_BEST = 0.01
"""Directions from which so nearly as much is visible are averaged."""

PENALTY_BEHIND, PENALTY_AT_SURFACE, PENALTY_EMPTY = 0.03, 0.3, 1.0
"""Non-match penalties: behind the seen surface nothing is known; what was seen to be empty is empty."""


class Viewpoint(NamedTuple):
    """The scanner's position, and the depth image of the scan from there.

    Attributes:
        towards: unit vector from the cloud to the viewpoint.
        middle: middle of the cloud.
        distance: of the viewpoint from the middle.
        pixel: side of a pixel, at the middle.
        corner: of the image.
        depth: distance of the nearest seen point in every pixel and its neighbours; infinite where none is.
    """

    towards: Float[np.ndarray, " 3"]
    middle: Float[np.ndarray, " 3"]
    distance: float
    pixel: float
    corner: Float[np.ndarray, " 2"]
    depth: Float[np.ndarray, "w h"]

    def penalty(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
        """Non-match penalty of points: how much it counts against a surface there that none was seen."""
        image, depth = _project(points - self.middle, self.towards, self.distance)
        at = np.floor((image - self.corner) / self.pixel).astype(int)
        inside = ((at >= 0) & (at < self.depth.shape)).all(axis=1)
        at = np.clip(at, 0, np.array(self.depth.shape) - 1)
        seen = np.where(inside, self.depth[at[:, 0], at[:, 1]], np.inf)
        penalty = np.where(depth > seen + self.pixel, PENALTY_BEHIND, PENALTY_AT_SURFACE)
        return np.where(depth < seen - 2 * self.pixel, PENALTY_EMPTY, penalty)


def find_viewpoint(surface: Surface) -> Viewpoint | None:
    """The viewpoint from which (almost) all points are visible; None if there is none.

    Args:
        surface: in any units.
    """
    directions = fibonacci(NUM_DIRECTIONS)
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    middle, diagonal = 0.5 * (low + high), float(np.linalg.norm(high - low))
    both = np.concatenate([directions, -directions])
    step = max(1, len(surface.points) // NUM_PROBES)
    pixel = max(PIXEL * surface.spacing, FINEST_PIXEL * diagonal)
    share = _visible_shares(surface, middle, both, DISTANCE * diagonal, pixel, step)
    best = np.argsort(-share, kind="stable")[:NUM_BEST]
    if share[best[0]] < ONE_SIDED:
        return None
    if _visible_shares(surface, middle, both[best], DISTANCE * diagonal, pixel, 1).max() < ONE_SIDED:
        return None
    towards = both[best[0]]
    if _bulge(surface, towards) < 0:
        towards = -towards
    facing = np.where(both @ towards > 0, share, 0.0)
    good = both[(facing > facing.max() - NEAR_BEST) & (both @ both[np.argmax(facing)] > 0.5)]
    towards = good.mean(axis=0) / np.linalg.norm(good.mean(axis=0))
    return _seen_from(surface.points, towards, middle, DISTANCE * diagonal, pixel)


def _seen_from(
    points: Float[np.ndarray, "n 3"],
    towards: Float[np.ndarray, " 3"],
    middle: Float[np.ndarray, " 3"],
    distance: float,
    pixel: float,
) -> Viewpoint:
    image, depth = _project(points - middle, towards, distance)
    corner = image.min(axis=0) - 2 * pixel
    at = np.floor((image - corner) / pixel).astype(int)
    nearest = np.full(at.max(axis=0) + 3, np.inf)
    np.minimum.at(nearest, (at[:, 0], at[:, 1]), depth)
    nearest = minimum_filter(nearest, 3, mode="constant", cval=np.inf)
    return Viewpoint(towards, middle, distance, pixel, corner, nearest)


def _project(
    points: Float[np.ndarray, "n 3"], towards: Float[np.ndarray, " 3"], distance: float
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, " n"]]:
    """Image coordinates, at the scale of the middle, and depth, of points about the middle."""
    depth = distance - points @ towards
    return points @ tangent_frames(towards) * (distance / depth)[:, None], depth


def _visible_shares(
    surface: Surface,
    middle: Float[np.ndarray, " 3"],
    directions: Float[np.ndarray, "d 3"],
    distance: float,
    pixel: float,
    step: int,
) -> Float[np.ndarray, " d"]:
    """Share of every `step`-th point that is visible from each direction; the pixels grow with the spacing."""
    points, normals = surface.points[::step] - middle, surface.normals[::step]
    side = pixel * np.sqrt(step)
    return np.array([_visible_share(points, normals, towards, distance, side) for towards in directions])


def _visible_share(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    towards: Float[np.ndarray, " 3"],
    distance: float,
    pixel: float,
) -> float:
    """Share of the points that are not hidden behind the nearest one of their pixel.

    A point behind it that lies in its tangent plane, or the other way round, is not hidden: the surface is slanted.
    """
    image, depth = _project(points, towards, distance)
    at = np.floor(image / pixel).astype(int)
    at -= at.min(axis=0)
    key = at[:, 0] * (at[:, 1].max() + 1) + at[:, 1]
    order = np.lexsort((depth, key))
    front = order[_first_of_run(key[order])]
    behind = depth[order] - depth[front] > 1.5 * pixel
    offset = points[order] - points[front]
    heights = [np.abs((offset * normals[rows]).sum(axis=1)) for rows in (front, order)]
    hidden: Bool[np.ndarray, " n"] = behind & (np.minimum(*heights) > 0.5 * pixel)
    return 1.0 - float(hidden.mean())


def _first_of_run(key: Int[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
    """For every entry of a sorted array the position of the first that equals it."""
    new = np.r_[True, key[1:] != key[:-1]]
    return np.flatnonzero(new)[np.cumsum(new) - 1]


def _bulge(surface: Surface, towards: Float[np.ndarray, " 3"]) -> float:
    """Positive where the surface, on the whole, bulges in a direction: neighbours lie behind the tangent planes."""
    near = cKDTree(surface.points).query(surface.points, k=32, workers=-1)[1]
    outward = surface.normals * np.sign(surface.normals @ towards)[:, None]
    return -float(((surface.points[near].mean(axis=1) - surface.points) * outward).sum())
