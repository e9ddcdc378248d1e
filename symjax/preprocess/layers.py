"""Sampling layers: points on planes or lines that lie a gap apart, such as the slices of a tomogram or scan lines.

The nearest neighbours of a point then all lie in its own layer, and a surface estimated from them is the layer and not
the object. Two signs show it, both without any scale:

- Lines: the directions to the nearest neighbours are all parallel. The lines may be curved, tilted and unevenly far
  apart, since each point is judged by itself.
- Planes: the directions to the nearest neighbours all lie in one plane, and the heights above it are a few equally
  spaced values. These are thick voxels, whose layers are filled areas.

An evenly spread subset of the points, about as far apart as the layers, samples the surface again.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import binary_erosion, binary_fill_holes
from scipy.spatial import cKDTree

from symjax.geometry.local_frames import tangent_frames

NUM_NEIGHBOURS = 4
"""Neighbours whose directions are compared. A point of a line has them all on the line."""

NUM_PROBES = 1000
"""Points that are tested."""

STRIDES = (1, 4, 16)
"""Every so many points are tested. Lines thickened by noise show in a thinned cloud, whose points along a line lie
farther apart than the noise."""

MIN_POINTS = 50
"""Fewest points that are tested."""

COLLINEAR = 0.9
"""Share of the mean square of the directions along one line above which the neighbours of a point are collinear."""

ON_LINES = 0.2
"""Share of points with collinear neighbours above which a cloud is sampled on lines. Measured: at most 0.1 on random
samples of surfaces, whole, cut, noisy, with outliers or seen from one side, and on scans; 0.3 to 1 on lines that are
more than twice as far apart as their points."""

COPLANAR = 0.03
"""Share of the mean square of the directions across a common plane below which a cloud is sampled on planes; 1/3 if all
directions are alike. Measured: 0 on voxels; 0.05 and more on flat objects."""

MIN_LAYERS = 3
"""Fewest planes. Two parallel planes may be the faces of a plate."""

EVEN = 1.2
"""Ratio of the largest tenth to the smallest tenth of the distances between planes up to which they are layers."""

WIDE = 1.8
"""Ratio of the gap to the spacing in a layer above which the neighbourhoods of points do not reach across the gap."""

ACROSS = 0.8
"""Cosine of the angle to the perpendicular of a line within which a neighbour lies across it, not along it."""

OUT = 0.3
"""Cosine of the angle to the layers' normal below which a line across may lie in the same layer: where an object is
thinner than the gap, the nearest line is the other side of the layer. With this, the gaps of 37 of 39 clouds came out
at 0.9 to 1.25 of the right ones; without it, at 0.3 and more."""

NUM_ACROSS = 64
"""Neighbours among which the next line is sought. If it is not among them, the cloud is thinned."""

SUBSET = 0.6
"""Distance between the points of the subset, in gaps."""

ROUNDS = 4
"""Maximum number of rounds. Where an object is thinner than the gap, the next line may be the other side of the same
layer. The gap is then too small, and another round finds that the subset still lies on lines."""

PIXEL, MAX_PIXELS = 1.5, 8
"""Side of the pixels of a layer, in spacings: just more than √2, so that a square grid leaves none empty. At most
MAX_PIXELS go to a gap, which bounds the memory."""

GROWTH = 1.2
"""Least factor by which the gap grows from one round to the next."""


class Layers(NamedTuple):
    """The layers on which a cloud is sampled, in the units of its points.

    Attributes:
        gap: distance between neighbouring layers, median over the points.
        spacing: distance between neighbouring points in a layer, median over the points.
        normal: unit vector across the layers; on the whole, if the layers are tilted or curved.
        are_planes: whether the layers are parallel planes an even gap apart; otherwise they are lines.
        num_apart: number of points that are SUBSET gaps apart: what there is to know about the surface.
    """

    gap: float
    spacing: float
    normal: Float[np.ndarray, " 3"]
    are_planes: bool
    num_apart: int = 0

    @property
    def note(self) -> str:
        """What was noticed and done, as a sentence."""
        kind = "planes" if self.are_planes else "lines"
        used = f"{self.num_apart} of the points, evenly spread over the surface, were used"
        if self.num_apart < MIN_POINTS:
            used = f"only {self.num_apart} of the points are as far apart as that, so that more were used"
        ratio = self.gap / self.spacing
        return f"the points lie on {kind} that are {ratio:.1f} times as far apart as the points on them: {used}"


def find_layers(points: Float[np.ndarray, "n 3"]) -> Layers | None:
    """Finds the layers on which a cloud is sampled.

    Args:
        points: distinct points, in any units.

    Returns:
        The layers, or None if the cloud is not sampled on layers.
    """
    for stride in STRIDES:
        some = points[::stride]
        if len(some) < MIN_POINTS:
            return None
        probes = np.arange(0, len(some), max(1, len(some) // NUM_PROBES))
        scatter, spacing = _directions(some, probes)
        found = _planes(points, scatter.mean(axis=0), spacing) if stride == 1 else None
        if found is not None:
            return found
        share, axes = np.linalg.eigh(scatter)
        on_line = share[:, 2] > COLLINEAR
        if on_line.mean() > ON_LINES + 2 * np.sqrt(ON_LINES * (1 - ON_LINES) / len(probes)):
            normal = np.linalg.eigh(scatter.mean(axis=0))[1][:, 0]
            gap = _gap(some, some[probes[on_line]], axes[on_line, :, 2], normal)
            if gap > WIDE * spacing:
                return Layers(gap, spacing, normal, False)
    return None


def layered_subset(points: Float[np.ndarray, "n 3"]) -> tuple[Int[np.ndarray, " m"], Layers | None]:
    """Selects points that sample the surface evenly, if the cloud is sampled on layers.

    Args:
        points: distinct points, in any units.

    Returns:
        Rows of the subset, ascending, and the layers. If there are no layers, all rows and None.
    """
    rows, layers = np.arange(len(points)), None
    for _ in range(ROUNDS):
        found = find_layers(points[rows])
        if found is None:
            break
        layers = found if layers is None else layers._replace(gap=max(found.gap, GROWTH * layers.gap))
        apart = rows[_subset(points[rows], layers)]
        layers = layers._replace(num_apart=len(apart))
        if len(apart) < MIN_POINTS:
            break
        rows = apart
    return rows, layers


def _directions(
    points: Float[np.ndarray, "n 3"], rows: Int[np.ndarray, " m"]
) -> tuple[Float[np.ndarray, "m 3 3"], float]:
    """Returns the mean square of the directions to the nearest neighbours of points, and the median distance there."""
    distance, near = cKDTree(points).query(points[rows], k=NUM_NEIGHBOURS + 1)
    direction = (points[near[:, 1:]] - points[rows][:, None]) / distance[:, 1:, None]
    scatter = np.matmul(direction.transpose(0, 2, 1), direction) / NUM_NEIGHBOURS
    return scatter, float(np.median(distance[:, 2]))


def _planes(points: Float[np.ndarray, "n 3"], scatter: Float[np.ndarray, "3 3"], spacing: float) -> Layers | None:
    """Finds parallel planes an even gap apart, from the mean square of the directions to the nearest neighbours."""
    share, axes = np.linalg.eigh(scatter)
    if share[0] > COPLANAR:
        return None
    height = np.sort(points @ axes[:, 0])
    layer = np.concatenate([[0], np.cumsum(np.diff(height) > 0.25 * spacing)])
    gaps = np.diff(np.bincount(layer, height) / np.bincount(layer))
    if len(gaps) + 1 < MIN_LAYERS or np.quantile(gaps, 0.9) > EVEN * np.quantile(gaps, 0.1):
        return None
    gap = float(np.median(gaps))
    return Layers(gap, spacing, axes[:, 0], True) if gap > WIDE * spacing else None


def _gap(
    points: Float[np.ndarray, "n 3"],
    probes: Float[np.ndarray, "m 3"],
    along: Float[np.ndarray, "m 3"],
    normal: Float[np.ndarray, " 3"],
) -> float:
    """Returns the median distance between neighbouring lines: of each probe, the mean to both sides."""
    gaps = np.full(len(probes), np.inf)
    left = np.arange(len(probes))
    while len(left) and len(points) >= MIN_POINTS:
        near = cKDTree(points).query(probes[left], k=min(NUM_ACROSS, len(points)))[1]
        offset = points[near] - probes[left][:, None]
        axis = along[left][:, None]
        across = offset - (offset * axis).sum(axis=2, keepdims=True) * axis
        distance = np.linalg.norm(across, axis=2)
        is_across = (distance > ACROSS * np.linalg.norm(offset, axis=2)) & (np.abs(across @ normal) > OUT * distance)
        first = across[np.arange(len(left)), np.argmax(is_across, axis=1)]
        opposite = is_across & ((across * first[:, None]).sum(axis=2) < 0)
        to_first, to_second = (np.where(side, distance, np.inf).min(axis=1) for side in (is_across, opposite))
        gaps[left] = np.where(np.isfinite(to_second), 0.5 * (to_first + to_second), to_first)
        left = left[np.isinf(gaps[left])]
        points = points[::NUM_NEIGHBOURS]
    return float(np.median(gaps[np.isfinite(gaps)])) if np.isfinite(gaps).any() else 0.0


def _subset(points: Float[np.ndarray, "n 3"], layers: Layers) -> Int[np.ndarray, " m"]:
    """Rows of points that sample the surface evenly; of filled layers, only the outlines.

    Between the outlines of two layers, the surface rises from one to the other. Voxels make it a step, whose tread is
    no part of the surface. All treads are parallel, and turn the best plane towards one that maps the layers onto
    themselves: by 4 to 6 degrees on an ellipsoid of eight layers, where outlines alone were wrong by 1 degree.
    """
    rows = np.arange(len(points))
    if layers.are_planes:
        rows = rows[~_on_tread(points, layers)]
    subset: Int[np.ndarray, " k"] = rows[_apart(points[rows], SUBSET * layers.gap)]
    return subset


def _on_tread(points: Float[np.ndarray, "n 3"], layers: Layers) -> Bool[np.ndarray, " n"]:
    """Which points lie in the area that the outline of a layer encloses, and not on a line, such as another outline."""
    height = points @ layers.normal
    layer = np.round((height - height.min()) / layers.gap).astype(int)
    pixel = max(PIXEL * layers.spacing, layers.gap / MAX_PIXELS)
    cell = np.floor(points @ tangent_frames(layers.normal) / pixel).astype(int)
    enclosed = np.zeros(len(points), bool)
    for rows in np.split(np.argsort(layer, kind="stable"), np.cumsum(np.bincount(layer))[:-1]):
        if len(rows):
            column, row = (cell[rows] - cell[rows].min(axis=0) + 1).T
            image = np.zeros((column.max() + 2, row.max() + 2), bool)
            image[column, row] = True
            enclosed[rows] = binary_erosion(binary_fill_holes(image))[column, row]
    scatter, _ = _directions(points, np.arange(len(points)))
    treads: Bool[np.ndarray, " n"] = enclosed & (np.linalg.eigvalsh(scatter)[:, 2] <= COLLINEAR)
    return treads


def _apart(points: Float[np.ndarray, "n 3"], distance: float) -> Int[np.ndarray, " m"]:
    """Rows of a largest subset of points that are at least a distance apart, chosen in order."""
    near = cKDTree(points).query_ball_point(points, distance)
    free = np.ones(len(points), bool)
    for row, around in enumerate(near):
        if free[row]:
            free[around] = False
            free[row] = True
    return np.flatnonzero(free)
