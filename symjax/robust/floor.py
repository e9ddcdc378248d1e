"""The floor under a scanned object: a dominant plane that the cloud stands on, and that hides the object's own mirror.

A floor is nearly symmetric about every plane upright on it. It is found as a large flat sheet (RANSAC over planes, each
from one point and its local normal) that has all the rest on one side and reaches further than the rest does: the side
of a box, a seat or a sole ends where the object ends, and is none.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from symjax.cloud import MIN_POINTS

SAMPLE = 2500
"""Points that find and judge a floor: a sample's neighbourhoods are wide enough to see a normal through the noise."""

NUM_NEIGHBOURS = 16
"""Neighbours that make a local normal."""

NUM_HYPOTHESES = 150
"""Planes tried: all of them miss a sheet of a tenth of the points once in 1e7 clouds."""

NUM_SHEETS = 3
"""Largest sheets judged: a table top may be larger than what is seen of the floor around its legs."""

MIN_SHARE = 0.1
"""Least share of the cloud in a floor; the flattest tenth of the cloud thus tells how thick a sheet may be."""

ALIKE = 0.9
"""Cosine of the angle (26 degrees) within which a noisy local normal agrees with a plane's."""

AGREE = 0.3
"""Share of a point's neighbours in a sheet where the local normal agrees: through a wall, a thin sheet cuts fewer."""

MIN_EXTENT = 10
"""Least extent of a floor in its own half thicknesses: a slice of scatter or of a thick part is no plane."""

MIN_RISE = 2
"""Least height of the object in the same unit: what does not rise out of the floor cannot be told from it."""

MAX_BELOW = 0.1
"""Largest share of the rest on the far side of a floor, where dense spots of scatter may pass for surface."""

MARGIN = 0.05
"""Of the object's width: only beyond this does a floor reach further, as an object's rim may be rounded."""

MIN_DIRECTIONS = 0.6
"""Share of the directions in which a floor reaches further: one that was seen on one side only does so in most."""

MIN_BEYOND = 0.2
"""Share of a floor's points beyond the object: more than a few corners."""

DENSE = 2
"""Surface is so much denser than scatter around it: 16 neighbours where 8 are expected are one case in a hundred."""


class Floor(NamedTuple):
    """Which points lie on the floor `normal . x = offset`, in the given units; the normal points to the object."""

    rows: Bool[np.ndarray, "n"]
    normal: Float[np.ndarray, "3"]
    offset: float


class _Sample(NamedTuple):
    """Some points with their neighbours and normals, places all over their hull, and half a sheet's thickness."""

    points: Float[np.ndarray, "m 3"]
    tree: cKDTree
    neighbours: Int[np.ndarray, "m k"]
    normals: Float[np.ndarray, "m 3"]
    places: Float[np.ndarray, "p 3"]
    band: float


class _Sheet(NamedTuple):
    """A plane with half its thickness, two axes in it, and which points of the sample lie on it."""

    normal: Float[np.ndarray, "3"]
    offset: float
    band: float
    axes: Float[np.ndarray, "3 2"]
    rows: Bool[np.ndarray, "m"]


def floor_rows(points: Float[np.ndarray, "n 3"], *, seed: int = 0) -> Floor | None:
    """The floor that the cloud stands on; None where there is none.

    What of the object lies flat within the floor's thickness, as a sole does, cannot be told from it and goes with it.

    Args:
        points: a cloud in any units and pose, perhaps with noise and outliers.
        seed: of the sample and of the planes tried.
    """
    if len(points) < MIN_POINTS:
        return None
    centre = points.mean(axis=0)
    scale = float(np.abs(points - centre).max())
    if scale == 0:
        return None
    unit = (points - centre) / scale
    rng = np.random.default_rng(seed)
    sample = _draw(unit, rng)
    free = np.ones(len(sample.points), bool)
    for _ in range(NUM_SHEETS):
        sheet = _largest_sheet(sample, free, rng)
        if sheet is None:
            return None
        up = _side_of_object(sample, sheet)
        if up:
            normal = up * sheet.normal
            return Floor(_all_rows(unit, sample, sheet), normal, float(up * scale * sheet.offset + normal @ centre))
        free &= ~sheet.rows
    return None


def _draw(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> _Sample:
    """A sample of the points, with the normals and the thickness of their neighbourhoods."""
    x = points[rng.permutation(len(points))[:SAMPLE]]
    tree = cKDTree(x)
    distance, neighbours = tree.query(x, k=NUM_NEIGHBOURS + 1)
    patch = x[neighbours] - x[neighbours].mean(axis=1, keepdims=True)
    variance, axes = np.linalg.eigh(patch.transpose(0, 2, 1) @ patch / (NUM_NEIGHBOURS + 1))
    # three deviations of the noise, which the flattest patches underrate by a quarter; and no floor is quite even
    deviation = np.sqrt(max(float(np.quantile(variance[:, 0], MIN_SHARE)), 0.0))
    band = 4 * deviation + 0.1 * float(np.median(distance[:, -1])) + 1e-9
    # random tetrahedra between extreme points fill the hull, whichever way a box of outliers is turned
    extreme = x[np.argmax(x @ x[rng.integers(len(x), size=64)].T, axis=0)]
    corners = extreme[rng.integers(len(extreme), size=(300, 4))]
    places = np.einsum("pi,pij->pj", rng.dirichlet(np.ones(4), size=300), corners)
    return _Sample(x, tree, neighbours, axes[:, :, 0], places, band)


def _largest_sheet(sample: _Sample, free: Bool[np.ndarray, "m"], rng: np.random.Generator) -> _Sheet | None:
    """The plane with the most free points near it whose normals agree, refined; None if too few lie on it."""
    among = rng.permutation(np.flatnonzero(free))
    if len(among) < MIN_SHARE * len(free):
        return None
    tried, judges = among[:NUM_HYPOTHESES], among[-1000:]
    normals = sample.normals[tried]
    offsets = (normals * sample.points[tried]).sum(axis=1)
    near = np.abs(sample.points[judges] @ normals.T - offsets) <= sample.band
    best = np.argmax((near & (np.abs(sample.normals[judges] @ normals.T) > ALIKE)).sum(axis=0))
    rows = _on_plane(sample, free, normals[best], offsets[best], sample.band)
    sheet = _Sheet(normals[best], offsets[best], sample.band, np.zeros((3, 2)), rows)
    for refit in (True, True, True, False):
        if sheet.rows.sum() < MIN_SHARE * len(free):
            return None
        if refit:
            sheet = _refit(sample, free, sheet)
    return sheet


def _refit(sample: _Sample, free: Bool[np.ndarray, "m"], sheet: _Sheet) -> _Sheet:
    """Least squares with Tukey's weights, against what leans on one side only; three robust deviations thick."""
    points = sample.points[sheet.rows]
    weight = (1 - ((points @ sheet.normal - sheet.offset) / sheet.band) ** 2) ** 2
    centre = weight @ points / weight.sum()
    axes = np.linalg.eigh(((points - centre).T * weight) @ (points - centre))[1]
    normal, offset = axes[:, 0], float(centre @ axes[:, 0])
    deviation = 1.4826 * float(np.median(np.abs(points @ normal - offset)))
    band = min(max(3 * deviation, 0.1 * sample.band), sample.band)
    return _Sheet(normal, offset, band, axes[:, 1:], _on_plane(sample, free, normal, offset, band))


def _on_plane(
    sample: _Sample, free: Bool[np.ndarray, "m"], normal: Float[np.ndarray, "3"], offset: float, band: float
) -> Bool[np.ndarray, "m"]:
    """Free points within the band whose neighbours are within it too: scatter spoils a normal rather than a count."""
    inside = np.abs(sample.points @ normal - offset) <= band
    return free & inside & (inside[sample.neighbours].mean(axis=1) >= AGREE)


def _all_rows(points: Float[np.ndarray, "n 3"], sample: _Sample, sheet: _Sheet) -> Bool[np.ndarray, "n"]:
    """All points within the floor's thickness and amid it, which is sparse beside a dense object: two of eight do."""
    rows = np.abs(points @ sheet.normal - sheet.offset) <= sheet.band
    inside = np.abs(sample.points @ sheet.normal - sheet.offset) <= sheet.band
    rows[rows] = inside[sample.tree.query(points[rows], k=8)[1]].sum(axis=1) >= 2
    return rows


def _side_of_object(sample: _Sample, sheet: _Sheet) -> int:
    """1 or -1 if the rest of the cloud stands on the sheet's positive or negative side; 0 if the sheet is no floor."""
    height = sample.points @ sheet.normal - sheet.offset
    rest = ~sheet.rows & (np.abs(height) > sheet.band)
    if rest.sum() < MIN_POINTS:
        return 0
    solid = _solid(sample.points[rest], sample.places)
    side = np.sign(height[rest])
    up = int(np.sign(side[solid].sum()))
    standing = solid & (side == up)
    if standing.sum() < (1 - MAX_BELOW) * solid.sum() or not standing.any():
        return 0
    on = sample.points[sheet.rows] @ sheet.axes
    rise = np.quantile(np.abs(height[rest][standing]), 0.9)
    if rise < MIN_RISE * sheet.band or np.ptp(on, axis=0).min() < MIN_EXTENT * sheet.band:
        return 0
    # the denser spots of scatter must not widen the object: one of a hundred, outside in one direction of many
    trim = min(0.005 + 0.02 * float((~solid).sum() / solid.sum()), 0.1)
    return up if _reaches_further(on, sample.points[rest][standing] @ sheet.axes, trim, 1.5 * sheet.band) else 0


def _solid(rest: Float[np.ndarray, "r 3"], places: Float[np.ndarray, "p 3"]) -> Bool[np.ndarray, "r"]:
    """Which points are surface rather than scatter, by their density and that at random places in the hull."""
    tree = cKDTree(rest)
    around = tree.query(places, k=[NUM_NEIGHBOURS])[0][:, 0]
    distance = tree.query(rest, k=[NUM_NEIGHBOURS + 1])[0][:, 0]
    # scatter leaves no tenth of the hull much emptier than its own thinnest spots; a surface leaves most of it empty,
    # and then whatever is not far emptier than the median place counts
    scattered = np.quantile(around, 0.9) < 1.2 * np.quantile(distance, 0.98)
    solid = distance**3 * (DENSE if scattered else 1 / DENSE) < np.median(around) ** 3
    # a cloud so flat or sparse that hardly any is denser than its hull cannot be told from scatter
    return solid if solid.mean() > 0.25 else np.ones(len(rest), bool)


def _reaches_further(
    floor: Float[np.ndarray, "f 2"], standing: Float[np.ndarray, "s 2"], trim: float, blur: float
) -> bool:
    """Whether the floor goes on, in most directions and with many points, beyond the convex footprint.

    The blur is what noise adds to the footprint, and what a slope at the object's rim hides within the floor.
    """
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    across = np.stack([np.cos(angle), np.sin(angle)])
    reach = np.quantile(standing @ across, 1 - trim, axis=0)
    edge = reach + MARGIN * float((reach + np.roll(reach, 16)).max()) + blur
    further = np.quantile(floor @ across, 0.98, axis=0) > edge
    beyond = (floor @ across > edge).any(axis=1)
    return bool(further.mean() >= MIN_DIRECTIONS and beyond.mean() >= MIN_BEYOND)
