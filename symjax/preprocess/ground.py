"""Detection of the ground plane that a scanned object stands on. It would hide the mirror planes of the object.

RANSAC looks for large flat sheets, with hypotheses from one point and its local normal. A sheet is the ground plane if
all other points lie on one side of it and it extends further than they do. The side of a box, a seat or a sole ends
where the object ends.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from symjax.geometry.local_frames import local_frames

MIN_POINTS = 50
"""Fewest points of a cloud with a ground plane, and of the sample above the plane: fewer do not show an object."""

SAMPLE_SIZE = 2500
"""Points in which a ground plane is sought: their neighbourhoods are wide enough to estimate normals despite noise."""

NUM_NEIGHBOURS = 16
"""Neighbours from which a local normal is estimated."""

NUM_HYPOTHESES = 150
"""RANSAC hypotheses: all of them miss a sheet of a tenth of the points once in 1e7 clouds."""

NUM_SHEETS = 3
"""Largest sheets tested: a table top may be larger than the visible part of the ground plane around its legs."""

MIN_FRACTION = 0.1
"""Least fraction of the cloud in a ground plane, so the flattest tenth of the cloud bounds the thickness of a sheet."""

MIN_COSINE = 0.9
"""Cosine of the angle (26 degrees) within which a noisy local normal agrees with the normal of a plane."""

MIN_NEIGHBOURS_INSIDE = 0.3
"""Least fraction of the neighbours of a point of a sheet that lie in the sheet; a sheet across a wall has fewer."""

MIN_WIDTH = 6
"""Least width of a ground plane in thicknesses: a slice of outliers or of a sparse cloud is as thick as it is wide."""

MAX_BELOW = 0.1
"""Largest fraction of the surface points below a ground plane; dense spots of outliers may be classified as surface."""

MARGIN = 0.05
"""A ground plane must extend further than the object by this fraction of its width, as its edges may be rounded."""

MIN_DIRECTIONS = 0.6
"""Least fraction of the directions in which a ground plane extends further than the object. One that is visible on one
side only does so in most directions."""


class _Sample(NamedTuple):
    """A random sample of the cloud.

    Attributes:
        points: points of the sample.
        tree: k-d tree of the points.
        neighbours: rows of the neighbours of each point.
        normals: local normal of each point.
        probes: positions throughout the convex hull.
        band: half the largest thickness of a sheet.
    """

    points: Float[np.ndarray, "m 3"]
    tree: cKDTree
    neighbours: Int[np.ndarray, "m k"]
    normals: Float[np.ndarray, "m 3"]
    probes: Float[np.ndarray, "p 3"]
    band: float


class _Sheet(NamedTuple):
    """A flat sheet of points.

    Attributes:
        normal: unit normal of its plane.
        offset: offset of its plane.
        band: half its thickness.
        axes: two orthonormal axes in the plane, in columns.
        rows: which points of the sample belong to it.
    """

    normal: Float[np.ndarray, " 3"]
    offset: float
    band: float
    axes: Float[np.ndarray, "3 2"]
    rows: Bool[np.ndarray, " m"]


def ground_mask(points: Float[np.ndarray, "n 3"], *, seed: int = 0) -> Bool[np.ndarray, " n"]:
    """Finds the points on the ground plane.

    Flat parts of the object within the thickness of the ground plane, such as a sole, are classified as ground.

    Args:
        points: points in any units and pose, possibly with noise and outliers.
        seed: seed of the sample and of the RANSAC hypotheses.

    Returns:
        True for each point on the ground plane; all False if there is no ground plane.
    """
    none = np.zeros(len(points), bool)
    if len(points) < MIN_POINTS or not np.ptp(points, axis=0).any():
        return none
    centre = points.mean(axis=0)
    unit = (points - centre) / np.abs(points - centre).max()
    rng = np.random.default_rng(seed)
    sample = _draw(unit, rng)
    remaining = np.ones(len(sample.points), bool)
    for _ in range(NUM_SHEETS):
        sheet = _largest_sheet(sample, remaining, rng)
        if sheet is None:
            break
        if _is_ground(sample, sheet):
            return _points_in_sheet(unit, sample, sheet)
        remaining &= ~sheet.rows
    return none


def _draw(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> _Sample:
    """Draws a sample of the points, and estimates normals and thickness from the neighbourhoods."""
    x = points[rng.permutation(len(points))[:SAMPLE_SIZE]]
    tree = cKDTree(x)
    distance, neighbours = tree.query(x, k=NUM_NEIGHBOURS + 1)
    variance, axes = local_frames(x, neighbours)
    # three standard deviations of the noise, which the flattest patches underestimate by a quarter, and a margin for
    # uneven ground
    deviation = np.sqrt(max(float(np.quantile(variance[:, 0], MIN_FRACTION)), 0.0))
    band = 4 * deviation + 0.1 * float(np.median(distance[:, -1])) + 1e-9
    # random tetrahedra of extreme points cover the hull, whatever the orientation of a box of outliers
    extreme = x[np.argmax(x @ x[rng.integers(len(x), size=64)].T, axis=0)]
    probes = np.einsum("pi,pij->pj", rng.dirichlet(np.ones(4), size=300), extreme[rng.integers(64, size=(300, 4))])
    return _Sample(x, tree, neighbours, axes[:, :, 0], probes, band)


def _largest_sheet(sample: _Sample, remaining: Bool[np.ndarray, " m"], rng: np.random.Generator) -> _Sheet | None:
    """Finds the sheet with the most remaining points whose normals agree with it, and refines it.

    Returns None if it has too few points.
    """
    shuffled = rng.permutation(np.flatnonzero(remaining))
    if len(shuffled) < MIN_FRACTION * len(remaining):
        return None
    hypotheses, voters = shuffled[:NUM_HYPOTHESES], shuffled[-1000:]
    normals = sample.normals[hypotheses]
    offsets = (normals * sample.points[hypotheses]).sum(axis=1)
    near = np.abs(sample.points[voters] @ normals.T - offsets) <= sample.band
    best = np.argmax((near & (np.abs(sample.normals[voters] @ normals.T) > MIN_COSINE)).sum(axis=0))
    sheet = _Sheet(normals[best], offsets[best], sample.band, np.zeros((3, 2)), remaining)
    for refit in (False, True, True, True):
        if refit:
            sheet = _refit(sample.points[sheet.rows], sheet, sample.band)
        inside = np.abs(sample.points @ sheet.normal - sheet.offset) <= sheet.band
        # outliers among the neighbours disturb a normal, but not a count
        rows = remaining & inside & (inside[sample.neighbours].mean(axis=1) >= MIN_NEIGHBOURS_INSIDE)
        if rows.sum() < MIN_FRACTION * len(rows):
            return None
        sheet = sheet._replace(rows=rows)
    return sheet


def _refit(points: Float[np.ndarray, "r 3"], sheet: _Sheet, thickest: float) -> _Sheet:
    """Fits a plane to the points of a sheet by least squares with Tukey's weights.

    The weights limit the effect of parts that adjoin the sheet on one side. The band is three robust standard
    deviations.
    """
    weight = (1 - ((points @ sheet.normal - sheet.offset) / sheet.band) ** 2) ** 2
    centre = weight @ points / weight.sum()
    axes = np.linalg.eigh(((points - centre).T * weight) @ (points - centre))[1]
    normal, offset = axes[:, 0], float(centre @ axes[:, 0])
    deviation = 1.4826 * float(np.median(np.abs(points @ normal - offset)))
    return _Sheet(normal, offset, min(max(3 * deviation, 0.1 * thickest), thickest), axes[:, 1:], sheet.rows)


def _points_in_sheet(points: Float[np.ndarray, "n 3"], sample: _Sample, sheet: _Sheet) -> Bool[np.ndarray, " n"]:
    """Finds the points of the whole cloud in a sheet, of whose eight neighbours in the sample at least two are in it.

    Two are enough because the object may be denser than the ground.
    """
    rows: Bool[np.ndarray, " n"] = np.abs(points @ sheet.normal - sheet.offset) <= sheet.band
    inside = np.abs(sample.points @ sheet.normal - sheet.offset) <= sheet.band
    rows[rows] = inside[sample.tree.query(points[rows], k=8)[1]].sum(axis=1) >= 2
    return rows


def _is_ground(sample: _Sample, sheet: _Sheet) -> bool:
    """Returns whether the other points lie on one side of a sheet, and the sheet extends further than they do."""
    height = sample.points @ sheet.normal - sheet.offset
    rest = ~sheet.rows & (np.abs(height) > sheet.band)
    if rest.sum() < MIN_POINTS:
        return False
    surface = _surface_mask(sample.points[rest], sample.probes)
    side = np.sign(height[rest])
    above = surface & (side == np.sign(side[surface].sum()))
    if above.sum() < (1 - MAX_BELOW) * surface.sum():
        return False
    ground = sample.points[sheet.rows] @ sheet.axes
    if np.ptp(ground, axis=0).min() < MIN_WIDTH * 2 * sheet.band:
        return False
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    across = np.stack([np.cos(angle), np.sin(angle)])
    # dense spots of outliers, a few of a hundred outliers, must not widen the footprint of the object
    trim = min(0.005 + 0.02 * float((~surface).sum() / surface.sum()), 0.1)
    reach = np.quantile(sample.points[rest][above] @ sheet.axes @ across, 1 - trim, axis=0)
    # noise blurs the footprint, and a slope at its edge ends within the thickness of the ground plane
    edge = reach + MARGIN * (reach + np.roll(reach, 16)).max() + 1.5 * sheet.band
    return bool(np.mean(np.quantile(ground @ across, 0.98, axis=0) > edge) >= MIN_DIRECTIONS)


def _surface_mask(rest: Float[np.ndarray, "r 3"], probes: Float[np.ndarray, "p 3"]) -> Bool[np.ndarray, " r"]:
    """Separates surface points from outliers by comparing their density with that at random positions in the hull."""
    tree = cKDTree(rest)
    around = tree.query(probes, k=[NUM_NEIGHBOURS])[0][:, 0]
    distance = tree.query(rest, k=[NUM_NEIGHBOURS + 1])[0][:, 0]
    # with outliers, no tenth of the hull is much emptier than where the points are sparsest, as it is for a surface
    # alone; the density of outliers is rarely twice that at the median probe, where chance puts 16 neighbours in place
    # of 8 once in a hundred
    has_outliers = np.quantile(around, 0.9) < 1.2 * np.quantile(distance, 0.98)
    surface = distance**3 * (2 if has_outliers else 0.5) < np.median(around) ** 3
    # if few points are denser than the hull, the cloud is too flat or sparse to distinguish surface from outliers
    return surface if surface.mean() > 0.25 else np.ones(len(rest), bool)
