"""Visibility: recognises a scan from one side, finds its viewpoint, and knows where the scan saw empty space.

In a scan from one side, no point hides another one from the viewpoint. Nor does it from the opposite direction, so the
bulge of the surface decides between the two: the side of a solid that a scanner sees bulges towards the scanner.
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
"""Distance of the viewpoint from the centre of the cloud, in diagonals. Scanners stand a few object sizes away, and
from farther away almost the same is visible."""

ONE_SIDED = 0.935
"""Fraction of the points that must be visible from the viewpoint of a scan from one side. Measured: 0.948 to 1 on such
scans, 0.48 to 0.92 on whole and cut objects."""

NUM_POINTS, NUM_DIRECTIONS, NUM_BEST = 800, 100, 4
"""Size of the search: points; directions on half the sphere, whose opposites are tried too; and best directions that
are tried again with all points, because a thin part does not hide anything if it has few points."""

PIXEL = 2.0
"""Side of a pixel of the depth image, in spacings. With pixels of this size few are empty by chance."""

FINEST_PIXEL = 1 / 750
"""Minimum side of a pixel, in diagonals, which bounds the memory. Seen from DISTANCE, the cloud is at most 4/3
diagonals wide, so that the image has little more than 2²⁰ pixels: enough for four million evenly spread points. If one
spot is far denser than the rest, the spacing is that of the spot, and an image with pixels of that size could fill any
memory."""

AVERAGED_FRACTION = 0.01
"""Directions are averaged if their visible fraction is within this of the best."""

PENALTY_BEHIND, PENALTY_AT_SURFACE, PENALTY_EMPTY = 0.03, 0.3, 1.0
"""Non-match penalties behind the visible surface, where nothing is known; at the surface; and in space that the scan
saw to be empty."""


class Viewpoint(NamedTuple):
    """The viewpoint of a scan from one side, and the depth image of the scan from there.

    Attributes:
        towards: unit vector from the centre of the cloud to the viewpoint.
        middle: centre of the cloud's bounding box.
        distance: distance of the viewpoint from the centre.
        pixel: side of a pixel, measured at the centre.
        corner: image coordinates of the first pixel's corner.
        depth: distance of the nearest point in each pixel and its eight neighbours; infinite if there is none.
    """

    towards: Float[np.ndarray, " 3"]
    middle: Float[np.ndarray, " 3"]
    distance: float
    pixel: float
    corner: Float[np.ndarray, " 2"]
    depth: Float[np.ndarray, "w h"]

    def penalty(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
        """Returns the non-match penalty of each point: how strongly the depth image contradicts a surface there."""
        image, depth = _project(points - self.middle, self.towards, self.distance)
        pixel = np.floor((image - self.corner) / self.pixel).astype(int)
        inside = ((pixel >= 0) & (pixel < self.depth.shape)).all(axis=1)
        pixel = np.clip(pixel, 0, np.array(self.depth.shape) - 1)
        visible_depth = np.where(inside, self.depth[pixel[:, 0], pixel[:, 1]], np.inf)
        penalty = np.where(depth > visible_depth + self.pixel, PENALTY_BEHIND, PENALTY_AT_SURFACE)
        return np.where(depth < visible_depth - 2 * self.pixel, PENALTY_EMPTY, penalty)


def find_viewpoint(surface: Surface) -> Viewpoint | None:
    """Finds the viewpoint of a scan from one side: almost all points are visible from it.

    Args:
        surface: the surface, in any units.

    Returns:
        The viewpoint, or None if the cloud is not a scan from one side.
    """
    half_sphere = fibonacci(NUM_DIRECTIONS)
    low, high = surface.points.min(axis=0), surface.points.max(axis=0)
    middle, diagonal = 0.5 * (low + high), float(np.linalg.norm(high - low))
    directions = np.concatenate([half_sphere, -half_sphere])
    step = max(1, len(surface.points) // NUM_POINTS)
    pixel = max(PIXEL * surface.spacing, FINEST_PIXEL * diagonal)
    fraction = _visible_fractions(surface, middle, directions, DISTANCE * diagonal, pixel, step)
    best = np.argsort(-fraction, kind="stable")[:NUM_BEST]
    if fraction[best[0]] < ONE_SIDED:
        return None
    if _visible_fractions(surface, middle, directions[best], DISTANCE * diagonal, pixel, 1).max() < ONE_SIDED:
        return None
    towards = directions[best[0]]
    if _bulge(surface, towards) < 0:
        towards = -towards
    fraction = np.where(directions @ towards > 0, fraction, 0.0)
    near_best = directions @ directions[np.argmax(fraction)] > 0.5
    averaged = directions[(fraction > fraction.max() - AVERAGED_FRACTION) & near_best]
    towards = averaged.mean(axis=0) / np.linalg.norm(averaged.mean(axis=0))
    return _viewpoint(surface.points, towards, middle, DISTANCE * diagonal, pixel)


def _viewpoint(
    points: Float[np.ndarray, "n 3"],
    towards: Float[np.ndarray, " 3"],
    middle: Float[np.ndarray, " 3"],
    distance: float,
    pixel: float,
) -> Viewpoint:
    """Renders the depth image of the points."""
    image, depth = _project(points - middle, towards, distance)
    corner = image.min(axis=0) - 2 * pixel
    column, row = np.floor((image - corner) / pixel).astype(int).T
    nearest = np.full((column.max() + 3, row.max() + 3), np.inf)
    np.minimum.at(nearest, (column, row), depth)
    nearest = minimum_filter(nearest, 3, mode="constant", cval=np.inf)
    return Viewpoint(towards, middle, distance, pixel, corner, nearest)


def _project(
    points: Float[np.ndarray, "n 3"], towards: Float[np.ndarray, " 3"], distance: float
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, " n"]]:
    """Returns image coordinates, at the scale of the centre, and depths of points relative to the centre."""
    depth = distance - points @ towards
    return points @ tangent_frames(towards) * (distance / depth)[:, None], depth


def _visible_fractions(
    surface: Surface,
    middle: Float[np.ndarray, " 3"],
    directions: Float[np.ndarray, "d 3"],
    distance: float,
    pixel: float,
    step: int,
) -> Float[np.ndarray, " d"]:
    """Returns the fraction of every `step`-th point that is visible from each direction.

    The pixels grow with the spacing of the remaining points.
    """
    points, normals = surface.points[::step] - middle, surface.normals[::step]
    side = pixel * np.sqrt(step)
    return np.array([_visible_fraction(points, normals, towards, distance, side) for towards in directions])


def _visible_fraction(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "n 3"],
    towards: Float[np.ndarray, " 3"],
    distance: float,
    pixel: float,
) -> float:
    """Returns the fraction of the points that are not hidden by the nearest point in their pixel.

    A point is not hidden if it lies near the tangent plane of the nearest point, or the nearest point near its tangent
    plane: both are then on one slanted surface.
    """
    image, depth = _project(points, towards, distance)
    column, row = np.floor(image / pixel).astype(int).T
    column, row = column - column.min(), row - row.min()
    index = column * (row.max() + 1) + row
    order = np.lexsort((depth, index))
    nearest = order[_first_of_run(index[order])]
    behind = depth[order] - depth[nearest] > 1.5 * pixel
    offset = points[order] - points[nearest]
    heights = [np.abs((offset * normals[rows]).sum(axis=1)) for rows in (nearest, order)]
    hidden: Bool[np.ndarray, " n"] = behind & (np.minimum(*heights) > 0.5 * pixel)
    return 1.0 - float(hidden.mean())


def _first_of_run(sorted_values: Int[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
    """Returns, for every entry of a sorted array, the position of the first entry with the same value."""
    is_first = np.r_[True, sorted_values[1:] != sorted_values[:-1]]
    first: Int[np.ndarray, " n"] = np.flatnonzero(is_first)[np.cumsum(is_first) - 1]
    return first


def _bulge(surface: Surface, towards: Float[np.ndarray, " 3"]) -> float:
    """Returns a positive number if the surface, on the whole, bulges towards a direction.

    The neighbours of a point then lie behind its tangent plane.
    """
    neighbours = cKDTree(surface.points).query(surface.points, k=32, workers=-1)[1]
    outward = surface.normals * np.sign(surface.normals @ towards)[:, None]
    return -float(((surface.points[neighbours].mean(axis=1) - surface.points) * outward).sum())
