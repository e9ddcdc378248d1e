"""The floor under a scanned object: a dominant plane that the cloud stands on, and that hides the object's own mirror.

A floor is nearly symmetric about every plane upright on it. It is found as the largest flat sheet (RANSAC over planes,
each from one point and its local normal) that has all the rest on one side and reaches further than the rest does:
the side of a box, a seat or a sole ends where the object ends, and is none.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

MIN_POINTS = 50

SAMPLE = 2500
"""Points that find and judge a floor: neighbourhoods of a sample are wide enough to see a normal through noise."""

NUM_NEIGHBOURS = 16
"""Neighbours that make a local normal."""

NUM_HYPOTHESES = 150
"""Planes tried: a sheet with a tenth of the points is missed by all of them once in 1e7 clouds."""

NUM_SHEETS = 3
"""Largest sheets judged: a table top may be larger than the floor seen around its legs."""

ALIKE = 0.9
"""Cosine of the angle (26 degrees) within which a noisy local normal agrees with a plane's."""

MIN_SHARE = 0.1
"""Least share of the cloud in a floor; the flattest tenth of the cloud also tells the noise of a sheet."""

MAX_BELOW = 0.1
"""Largest share of the rest on the far side of a floor: twice what passes for surface in scatter on both sides."""

MARGIN = 0.05
"""Of the object's width: a floor counts as reaching further from here on. The rim of an object has rounded edges."""

MIN_DIRECTIONS = 0.6
"""Share of the directions in which a floor reaches further; one seen on one side of the object only does in most."""

MIN_BEYOND = 0.2
"""Share of a floor's points that lie beyond the object: more than the corners that any footprint leaves."""

DENSE = 2.0
"""Surface is this much denser than the scatter: 16 neighbours where 8 are expected is one in a hundred."""


AGREE = 0.3


class Floor(NamedTuple):
    """Which points lie on the floor `normal . x = offset`, in the given units; the normal points to the object."""

    rows: Bool[np.ndarray, "n"]
    normal: Float[np.ndarray, "3"]
    offset: float


class _Sample(NamedTuple):
    """Some of the points, each with its neighbours and normal; places all over their hull; half a sheet's thickness."""

    points: Float[np.ndarray, "m 3"]
    tree: cKDTree
    neighbours: Int[np.ndarray, "m k"]
    normals: Float[np.ndarray, "m 3"]
    places: Float[np.ndarray, "p 3"]
    band: float


class _Sheet(NamedTuple):
    """Plane, half thickness, axes in the plane, and the sample's points on it."""

    normal: Float[np.ndarray, "3"]
    offset: float
    band: float
    axes: Float[np.ndarray, "2 3"]
    rows: Bool[np.ndarray, "m"]


def floor_rows(points: Float[np.ndarray, "n 3"], *, seed: int = 0) -> Floor | None:
    """The floor that the cloud stands on; None where there is none.

    What touches the floor within its thickness, as the sole of an object does, cannot be told from it and goes with it.

    Args:
        points: a cloud in any units and pose, perhaps with noise and outliers.
        seed: of the sample and of the planes tried.
    """
    points = np.asarray(points, dtype=float)
    centre = points.mean(axis=0) if len(points) else np.zeros(3)
    scale = float(np.abs(points - centre).max(initial=0.0))
    if len(points) < MIN_POINTS or scale == 0:
        return None
    unit = (points - centre) / scale
    rng = np.random.default_rng(seed)
    sample = _draw(unit, rng)
    free = np.ones(len(sample.points), bool)
    for _ in range(NUM_SHEETS):
        sheet = _largest_sheet(sample, free, rng)
        if sheet is None:
            return None
        normal = _up(sample, sheet)
        if normal is not None:
            rows = _rows(unit, sample, sheet)
            return Floor(rows, normal, scale * float(np.sign(normal @ sheet.normal)) * sheet.offset + normal @ centre)
        free &= ~sheet.rows
    return None


def _draw(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> _Sample:
    """A sample of the points, with the normals and the thickness of their neighbourhoods."""
    x = points[rng.permutation(len(points))[:SAMPLE]]
    tree = cKDTree(x)
    distance, neighbours = tree.query(x, k=NUM_NEIGHBOURS + 1)
    patch = x[neighbours] - x[neighbours].mean(axis=1, keepdims=True)
    squares, axes = np.linalg.eigh(patch.transpose(0, 2, 1) @ patch / (NUM_NEIGHBOURS + 1))
    # three deviations of the noise, which the flattest patches underrate by a quarter, and some unevenness
    noise = np.sqrt(max(float(np.quantile(squares[:, 0], MIN_SHARE)), 0.0))
    band = 4 * noise + 0.1 * float(np.median(distance[:, -1])) + 1e-9
    # random tetrahedra of extreme points fill the hull as a box of scatter would, in whatever pose
    extreme = x[np.argmax(x @ x[rng.integers(len(x), size=64)].T, axis=0)]
    corners = extreme[rng.integers(len(extreme), size=(300, 4))]
    places = np.einsum("pi,pij->pj", rng.dirichlet(np.ones(4), size=300), corners)
    return _Sample(x, tree, neighbours, axes[:, :, 0], places, band)


def _largest_sheet(sample: _Sample, free: Bool[np.ndarray, "m"], rng: np.random.Generator) -> _Sheet | None:
    """The plane with the most free points near it whose normals agree, refined; None if too few lie on it."""
    among = rng.permutation(np.flatnonzero(free))
    if len(among) < MIN_SHARE * len(free):
        return None
    normals, judges = sample.normals[among[:NUM_HYPOTHESES]], among[-1000:]
    offsets = np.einsum("hi,hi->h", normals, sample.points[among[:NUM_HYPOTHESES]])
    near = np.abs(sample.points[judges] @ normals.T - offsets) <= sample.band
    best = np.argmax((near & (np.abs(sample.normals[judges] @ normals.T) > ALIKE)).sum(axis=0))
    normal, offset, band = normals[best], offsets[best], sample.band
    axes = np.zeros((2, 3))
    for fit in (True, True, True, False):
        height = sample.points @ normal - offset
        inside = np.abs(height) <= band
        rows = free & inside & _agree(inside, sample.neighbours)
        if rows.sum() < MIN_SHARE * len(free):
            return None
        if fit:
            normal, offset, axes = _fitted(sample.points[rows], height[rows] / band)
            deviation = 1.4826 * float(np.median(np.abs(sample.points[rows] @ normal - offset)))
            band = min(max(3 * deviation, 0.1 * sample.band), sample.band)
    return _Sheet(normal, offset, band, axes, rows)


def _agree(inside: Bool[np.ndarray, "m"], neighbours: Int[np.ndarray, "r k"]) -> Bool[np.ndarray, "r"]:
    """Whether half of the neighbours are inside as well: scatter among them spoils a normal, but not the count."""
    return inside[neighbours].mean(axis=1) >= AGREE


def _fitted(
    points: Float[np.ndarray, "r 3"], height: Float[np.ndarray, "r"]
) -> tuple[Float[np.ndarray, "3"], float, Float[np.ndarray, "2 3"]]:
    """Least squares plane and axes in it; Tukey's weights spare it what leans on one side."""
    weight = (1 - height**2) ** 2
    weight /= weight.sum()
    centre = weight @ points
    axes = np.linalg.eigh(((points - centre).T * weight) @ (points - centre))[1]
    return axes[:, 0], float(centre @ axes[:, 0]), axes[:, 1:].T


def _up(sample: _Sample, sheet: _Sheet) -> Float[np.ndarray, "3"] | None:
    """The normal towards the rest of the cloud if the rest stands on the sheet; None if the sheet is no floor."""
    height = sample.points @ sheet.normal - sheet.offset
    rest = ~sheet.rows & (np.abs(height) > sheet.band)
    if rest.sum() <= NUM_NEIGHBOURS:
        return None
    solid = _solid(sample.points[rest], sample.places)
    side = np.sign(height[rest])
    up = np.sign(side[solid].sum())
    standing = solid & (side == up)
    if standing.sum() < (1 - MAX_BELOW) * solid.sum():
        return None
    # scatter that passes for surface must not widen the object
    trim = 0.005 + 0.02 * float(np.mean(~solid) / np.mean(solid))
    if not _reaches_further(sheet, sample.points[sheet.rows], sample.points[rest][standing], min(trim, 0.1)):
        return None
    return up * sheet.normal


def _solid(rest: Float[np.ndarray, "r 3"], places: Float[np.ndarray, "p 3"]) -> Bool[np.ndarray, "r"]:
    """Which points are surface and no scatter: they lie denser than half of the places in the hull.

    If hardly any do, the cloud is too flat or too sparse to tell, and all count.
    """
    tree = cKDTree(rest)
    typical = float(np.median(tree.query(places, k=[NUM_NEIGHBOURS])[0]))
    dense = tree.query(rest, k=[NUM_NEIGHBOURS + 1])[0][:, 0] < typical * DENSE ** (-1 / 3)
    return dense if dense.mean() > 0.25 else np.ones(len(rest), bool)


def _reaches_further(
    sheet: _Sheet, floor: Float[np.ndarray, "f 3"], standing: Float[np.ndarray, "s 3"], trim: float
) -> bool:
    """Whether the floor goes on beyond the convex footprint of what stands on it, on most sides and with many points.

    The noise may blur the footprint, and slopes at its rim go down into the thickness of the floor.
    """
    angle = np.linspace(0, 2 * np.pi, 32, endpoint=False)
    across = sheet.axes.T @ np.stack([np.cos(angle), np.sin(angle)])
    reach = np.quantile(standing @ across, 1 - trim, axis=0)
    width = float((reach + np.roll(reach, 16)).max())
    edge = reach + MARGIN * width + 1.5 * sheet.band
    further = np.quantile(floor @ across, 0.98, axis=0) > edge
    beyond = (floor @ across > edge).any(axis=1)
    return bool(further.mean() >= MIN_DIRECTIONS and beyond.mean() >= MIN_BEYOND)


def _rows(points: Float[np.ndarray, "n 3"], sample: _Sample, sheet: _Sheet) -> Bool[np.ndarray, "n"]:
    """All the points on the floor: within its thickness, and among others that are."""
    rows = np.abs(points @ sheet.normal - sheet.offset) <= sheet.band
    inside = np.abs(sample.points @ sheet.normal - sheet.offset) <= sheet.band
    rows[rows] = _agree(inside, sample.tree.query(points[rows], k=6)[1])
    return rows
