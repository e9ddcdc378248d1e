"""The ground plane under a scanned object: the cloud stands on it, and it hides the object's own mirror.

It is found as a large flat sheet (RANSAC over planes, each from one point and its local normal) that has all the rest
on one side and reaches further than the rest: the side of a box, a seat or a sole ends where the object ends.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from symjax.geometry.local_frames import local_frames

MIN_POINTS = 50
"""Fewest points of a cloud with a ground plane, and of what the sample leaves above it: fewer show no object."""

SAMPLE = 2500
"""Points that find and judge a ground plane: their neighbourhoods are wide enough to see a normal through noise."""

NUM_NEIGHBOURS = 16
"""Neighbours that make a local normal."""

NUM_HYPOTHESES = 150
"""Planes tried: all of them miss a sheet of a tenth of the points once in 1e7 clouds."""

NUM_SHEETS = 3
"""Largest sheets judged: a table top may be larger than what is seen of the ground plane around its legs."""

MIN_SHARE = 0.1
"""Least share of the cloud in a ground plane, so the flattest tenth of the cloud bounds the thickness of a sheet."""

ALIKE = 0.9
"""Cosine of the angle (26 degrees) within which a noisy local normal agrees with a plane's."""

AGREE = 0.3
"""Share of a point's neighbours in a sheet where the local normal agrees: through a wall, a thin sheet cuts fewer."""

MIN_WIDTH = 6
"""Least width of a ground plane in thicknesses: a slice of scatter, or part of a sparse cloud, is as thick as wide."""

MAX_BELOW = 0.1
"""Largest share of the rest on the far side of a ground plane, where dense spots of scatter may pass for surface."""

MARGIN = 0.05
"""Of the object's width: only beyond this does a ground plane reach further, as an object's rim may be rounded."""

MIN_DIRECTIONS = 0.6
"""Share of the directions in which a ground plane reaches further: one seen on one side only does so in most."""


class _Sample(NamedTuple):
    """Some points with their neighbours and normals, places all over their hull, and half the greatest thickness."""

    points: Float[np.ndarray, "m 3"]
    tree: cKDTree
    neighbours: Int[np.ndarray, "m k"]
    normals: Float[np.ndarray, "m 3"]
    places: Float[np.ndarray, "p 3"]
    band: float


class _Sheet(NamedTuple):
    """A plane with half its thickness, two axes in it, and which points of the sample lie on it."""

    normal: Float[np.ndarray, " 3"]
    offset: float
    band: float
    axes: Float[np.ndarray, "3 2"]
    rows: Bool[np.ndarray, " m"]


def ground_rows(points: Float[np.ndarray, "n 3"], *, seed: int = 0) -> Bool[np.ndarray, " n"]:
    """Which points lie on the ground plane that the cloud stands on; none where there is no ground plane.

    Parts of the object that lie flat within the ground plane's thickness, as a sole does, are taken for the ground.

    Args:
        points: a cloud in any units and pose, perhaps with noise and outliers.
        seed: of the sample and of the planes tried.
    """
    none = np.zeros(len(points), bool)
    if len(points) < MIN_POINTS or not np.ptp(points, axis=0).any():
        return none
    centre = points.mean(axis=0)
    unit = (points - centre) / np.abs(points - centre).max()
    rng = np.random.default_rng(seed)
    sample = _draw(unit, rng)
    free = np.ones(len(sample.points), bool)
    for _ in range(NUM_SHEETS):
        sheet = _largest_sheet(sample, free, rng)
        if sheet is None:
            break
        if _is_ground(sample, sheet):
            return _all_rows(unit, sample, sheet)
        free &= ~sheet.rows
    return none


def _draw(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> _Sample:
    """A sample of the points, with the normals and the thickness of their neighbourhoods."""
    x = points[rng.permutation(len(points))[:SAMPLE]]
    tree = cKDTree(x)
    distance, neighbours = tree.query(x, k=NUM_NEIGHBOURS + 1)
    variance, axes = local_frames(x, neighbours)
    # three deviations of the noise, which the flattest patches underrate by a quarter; and no ground is quite even
    deviation = np.sqrt(max(float(np.quantile(variance[:, 0], MIN_SHARE)), 0.0))
    band = 4 * deviation + 0.1 * float(np.median(distance[:, -1])) + 1e-9
    # random tetrahedra between extreme points fill the hull, whichever way a box of outliers is turned
    extreme = x[np.argmax(x @ x[rng.integers(len(x), size=64)].T, axis=0)]
    places = np.einsum("pi,pij->pj", rng.dirichlet(np.ones(4), size=300), extreme[rng.integers(64, size=(300, 4))])
    return _Sample(x, tree, neighbours, axes[:, :, 0], places, band)


def _largest_sheet(sample: _Sample, free: Bool[np.ndarray, " m"], rng: np.random.Generator) -> _Sheet | None:
    """The plane with the most free points near it whose normals agree, refined; None if too few lie on it."""
    among = rng.permutation(np.flatnonzero(free))
    if len(among) < MIN_SHARE * len(free):
        return None
    tried, judges = among[:NUM_HYPOTHESES], among[-1000:]
    normals = sample.normals[tried]
    offsets = (normals * sample.points[tried]).sum(axis=1)
    near = np.abs(sample.points[judges] @ normals.T - offsets) <= sample.band
    best = np.argmax((near & (np.abs(sample.normals[judges] @ normals.T) > ALIKE)).sum(axis=0))
    sheet = _Sheet(normals[best], offsets[best], sample.band, np.zeros((3, 2)), free)
    for refit in (False, True, True, True):
        if refit:
            sheet = _refit(sample.points[sheet.rows], sheet, sample.band)
        inside = np.abs(sample.points @ sheet.normal - sheet.offset) <= sheet.band
        # scatter among the neighbours spoils a normal, but not a count
        rows = free & inside & (inside[sample.neighbours].mean(axis=1) >= AGREE)
        if rows.sum() < MIN_SHARE * len(rows):
            return None
        sheet = sheet._replace(rows=rows)
    return sheet


def _refit(points: Float[np.ndarray, "r 3"], sheet: _Sheet, thickest: float) -> _Sheet:
    """Least squares with Tukey's weights, against what leans on one side only; three robust deviations thick."""
    weight = (1 - ((points @ sheet.normal - sheet.offset) / sheet.band) ** 2) ** 2
    centre = weight @ points / weight.sum()
    axes = np.linalg.eigh(((points - centre).T * weight) @ (points - centre))[1]
    normal, offset = axes[:, 0], float(centre @ axes[:, 0])
    deviation = 1.4826 * float(np.median(np.abs(points @ normal - offset)))
    return _Sheet(normal, offset, min(max(3 * deviation, 0.1 * thickest), thickest), axes[:, 1:], sheet.rows)


def _all_rows(points: Float[np.ndarray, "n 3"], sample: _Sample, sheet: _Sheet) -> Bool[np.ndarray, " n"]:
    """All points in the slab with at least two of eight sample neighbours in it: an object may be denser."""
    rows = np.abs(points @ sheet.normal - sheet.offset) <= sheet.band
    inside = np.abs(sample.points @ sheet.normal - sheet.offset) <= sheet.band
    rows[rows] = inside[sample.tree.query(points[rows], k=8)[1]].sum(axis=1) >= 2
    return rows


def _is_ground(sample: _Sample, sheet: _Sheet) -> bool:
    """Whether the rest of the cloud stands on one side of the sheet, and the sheet reaches further."""
    height = sample.points @ sheet.normal - sheet.offset
    rest = ~sheet.rows & (np.abs(height) > sheet.band)
    if rest.sum() < MIN_POINTS:
        return False
    solid = _solid(sample.points[rest], sample.places)
    side = np.sign(height[rest])
    standing = solid & (side == np.sign(side[solid].sum()))
    if standing.sum() < (1 - MAX_BELOW) * solid.sum():
        return False
    ground = sample.points[sheet.rows] @ sheet.axes
    if np.ptp(ground, axis=0).min() < MIN_WIDTH * 2 * sheet.band:
        return False
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    across = np.stack([np.cos(angle), np.sin(angle)])
    # the dense spots of scatter, a few of a hundred points of it, must not widen the object's footprint
    trim = min(0.005 + 0.02 * float((~solid).sum() / solid.sum()), 0.1)
    reach = np.quantile(sample.points[rest][standing] @ sheet.axes @ across, 1 - trim, axis=0)
    # noise blurs the footprint, and a slope at its rim runs out within the thickness of the ground plane
    edge = reach + MARGIN * (reach + np.roll(reach, 16)).max() + 1.5 * sheet.band
    return bool(np.mean(np.quantile(ground @ across, 0.98, axis=0) > edge) >= MIN_DIRECTIONS)


def _solid(rest: Float[np.ndarray, "r 3"], places: Float[np.ndarray, "p 3"]) -> Bool[np.ndarray, " r"]:
    """Which points are surface rather than scatter, by their density and that at random places in the hull."""
    tree = cKDTree(rest)
    around = tree.query(places, k=[NUM_NEIGHBOURS])[0][:, 0]
    distance = tree.query(rest, k=[NUM_NEIGHBOURS + 1])[0][:, 0]
    # scatter leaves no tenth of the hull much emptier than its own thinnest spots, as surface alone does; it is seldom
    # twice as dense as at the median place, where chance puts 16 neighbours for 8 once in a hundred
    scattered = np.quantile(around, 0.9) < 1.2 * np.quantile(distance, 0.98)
    solid = distance**3 * (2 if scattered else 0.5) < np.median(around) ** 3
    # a cloud so flat or sparse that hardly any is denser than its hull cannot be told from scatter
    return solid if solid.mean() > 0.25 else np.ones(len(rest), bool)
