"""Sheet: a flat cloud as a two-dimensional problem.

All normals of a flat cloud are those of its sheet, so that heights above tangent planes say nothing about a mirror
plane. What distinguishes the planes is the outline of the sheet, or the cloud itself if it is a curve. The outline is a
`Surface` too, whose normals lie in the sheet. The search and the refinement then work as for any other cloud, and all
planes stay upright on the sheet: mirror images of points and normals of the sheet lie in the sheet, so no derivative
turns the plane out of it.

Everything here is in the cloud frame, whose last axis is the normal of the sheet.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import Delaunay, cKDTree

from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.robust.surface import BOUNDARY_SHIFT, Surface, confidence_of, tolerance_of
from symjax.robust.verification.thresholds import FoundThresholds

CURVE_NEIGHBOURS = (12, 24, 48, 96, 192)
"""Sizes of the neighbourhoods in which a cloud may look like a curve. Noise widens a curve: small neighbourhoods of its
points then look filled."""

CURVE = 0.1
"""Ratio of the two principal variances of a neighbourhood, median over the points, below which a cloud is a curve.
A filled sheet has a ratio of about 0.6 at all sizes."""

LARGEST = 0.12
"""Maximum radius of such a neighbourhood, in units of the cloud's diagonal."""

OUTLINE_STEP, OUTLINE_NEIGHBOURS = 0.5, 20
"""Distance between the points of the outline of a filled sheet, in spacings of the sheet, and the number of their
neighbours from which normals and thickness are estimated. With 12 neighbours, the roughness of the outline is
underestimated: noise of 1 % of the diagonal then lowers the score of a mirror plane by 0.05 to 0.1 more."""

ALPHA = 2.5
"""Radius of the largest empty disc that may lie within a filled sheet, in spacings. A disc of that size is empty by
chance once in 10⁸ places; a sparse part may have a third of the usual density."""

FINEST = 0.003
"""Minimum spacing that is assumed for a curve, in diagonals. The voxel grid, whose voxels are 0.02 wide, brings
the planes to within a few of these."""

OWN_PLANE = 0.99
"""Cosine of the angle to the sheet's normal above which an initial plane is the sheet's own, and is not used."""

FLAT_THRESHOLDS = FoundThresholds(base=0.55, per_background=0.2, most=0.7, exact=0.5, exactness=0.62)
"""Threshold of the score on an outline. Measured on complete outlines: 0.8 to 1 for mirror planes; 0.2 to 0.58 for the
best plane of an outline without one, with an exactness of at most 0.57."""


class Sheet(NamedTuple):
    """A flat cloud.

    Attributes:
        whole: all points, projected on the sheet. The normals are those of the sheet if it is filled.
        outline: the outline of a filled sheet, or the curve itself.
        filled: whether the cloud is a filled sheet and not a curve.
        patch_size: number of neighbours to which a patch of the outline is fitted.
        noise: standard deviation of the points across the sheet.
    """

    whole: Surface
    outline: Surface
    filled: bool
    patch_size: int
    noise: float

    @property
    def note(self) -> str:
        """What was assumed about the cloud, as a sentence."""
        if self.filled:
            return "the cloud is a filled flat sheet: its outline decides which planes are mirror planes"
        return "the cloud is a flat curve: only planes upright on its sheet are considered"


def find_sheet(points: Float[np.ndarray, "n 3"]) -> Sheet:
    """Estimates the sheet and the outline of a flat cloud.

    Args:
        points: distinct points of a flat cloud in the cloud frame, in units of its diagonal.
    """
    noise = float(np.sqrt((points[:, 2] ** 2).mean()))
    flat = points * np.array([1.0, 1.0, 0.0])
    size = _curve_neighbours(flat)
    if size is not None:
        curve = _curve(flat, size)
        return Sheet(curve, curve, False, _patch_size(curve, size), noise)
    tree = cKDTree(flat)
    distances = tree.query(flat, k=7)[0][:, 6]
    spacing = float(np.median(distances) / np.sqrt(6 / np.pi))
    edges = _alpha_outline(flat[:, :2], ALPHA * spacing)
    boundary = np.zeros(len(flat), bool)
    boundary[edges] = True
    normals = np.tile([0.0, 0.0, 1.0], (len(flat), 1))
    whole = Surface(flat, normals, np.ones(len(flat)), boundary, spacing, 0.0, False, tree)
    outline = _curve(_resampled(flat, edges, OUTLINE_STEP * spacing), OUTLINE_NEIGHBOURS, spacing)
    return Sheet(whole, outline, True, _patch_size(outline, OUTLINE_NEIGHBOURS), noise)


def _curve_neighbours(flat: Float[np.ndarray, "n 3"]) -> int | None:
    """Returns the size of the smallest neighbourhoods in which a cloud looks like a curve; None if it is filled."""
    tested = flat[:: max(1, len(flat) // 500)]
    most = min(CURVE_NEIGHBOURS[-1], len(flat) - 1)
    distances, neighbours = cKDTree(flat).query(tested, k=most + 1)
    for size in CURVE_NEIGHBOURS:
        if size > most or np.median(distances[:, size]) > LARGEST:
            break
        values = _principal(flat, neighbours[:, 1 : size + 1], np.ones(len(flat)))[0]
        if np.median(values[:, 0] / values[:, 1]) < CURVE:
            return size
    return None


def _principal(
    flat: Float[np.ndarray, "n 3"], neighbours: Int[np.ndarray, "m k"], weight: Float[np.ndarray, " n"]
) -> tuple[Float[np.ndarray, "m 2"], Float[np.ndarray, "m 2 2"]]:
    """Returns the principal variances of each neighbourhood within the sheet, ascending, and directions in columns."""
    normalised = weight[neighbours] + 1e-6
    normalised = normalised / normalised.sum(axis=1, keepdims=True)
    offset = flat[neighbours, :2]
    offset = offset - np.matmul(normalised[:, None], offset)
    weighted = np.sqrt(normalised)[:, :, None] * offset
    values, vectors = np.linalg.eigh(np.matmul(weighted.transpose(0, 2, 1), weighted))
    return np.maximum(values, 1e-300), vectors


def _curve(flat: Float[np.ndarray, "n 3"], size: int, least: float = FINEST) -> Surface:
    """Estimates a curve as a surface whose normals lie in the sheet, with a spacing of at least `least`."""
    tree = cKDTree(flat)
    count = min(size, len(flat) - 1)
    distances, neighbours = (found[:, 1:] for found in tree.query(flat, k=count + 1, workers=-1))
    # half of the k neighbours lie on either side
    spacing = max(float(np.median(distances[:, -1])) * 2 / count, least)
    confidence = np.ones(len(flat))
    normals = np.zeros_like(flat)
    for _ in range(2):
        values, vectors = _principal(flat, neighbours, confidence)
        normals[:, :2] = vectors[:, :, 0]
        thickness = float(np.median(np.sqrt(values[:, 0])))
        confidence = confidence_of(flat, normals, neighbours, tolerance_of(spacing, thickness))
    shift = flat[neighbours].mean(axis=1) - flat
    shift -= (shift * normals).sum(axis=1, keepdims=True) * normals
    boundary = np.linalg.norm(shift, axis=1) > BOUNDARY_SHIFT * distances[:, -1]
    return Surface(flat, normals, confidence, boundary, spacing, thickness, False, tree)


def _patch_size(curve: Surface, size: int) -> int:
    """Returns the number of neighbours of a patch, which covers twelve of the curve's spacings at least."""
    distance = curve.tree.query(curve.points, k=[min(size + 1, len(curve.points))])[0]
    enlarged = size * 4 * curve.spacing / float(np.median(distance))
    return int(min(max(size, enlarged), 200, len(curve.points) - 1))


def _alpha_outline(flat: Float[np.ndarray, "n 2"], alpha: float) -> Int[np.ndarray, "e 2"]:
    """Returns the edges of the boundary of the alpha shape, as pairs of rows of the points.

    The alpha shape is the part of the Delaunay triangulation whose triangles have a circumradius below alpha.
    Edelsbrunner, Kirkpatrick, Seidel, "On the shape of a set of points in the plane", IEEE Trans. Inf. Theory, 1983.
    """
    triangles = Delaunay(flat).simplices
    corner = flat[triangles]
    side = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)
    (a, b), c = (corner[:, k] - corner[:, 0] for k in (1, 2)), side
    area = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    kept = triangles[c.prod(axis=1) < 4 * alpha * area]
    edges = np.sort(np.concatenate([kept[:, [0, 1]], kept[:, [1, 2]], kept[:, [0, 2]]]), axis=1)
    distinct, count = np.unique(edges, axis=0, return_counts=True)
    boundary: Int[np.ndarray, "e 2"] = distinct[count == 1]
    return boundary


def _resampled(flat: Float[np.ndarray, "n 3"], edges: Int[np.ndarray, "e 2"], step: float) -> Float[np.ndarray, "b 3"]:
    """Returns points at even steps on edges between points."""
    start, along = flat[edges[:, 0]], flat[edges[:, 1]] - flat[edges[:, 0]]
    count = np.ceil(np.linalg.norm(along, axis=1) / step).astype(int)
    edge = np.repeat(np.arange(len(edges)), count)
    part = np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5
    points: Float[np.ndarray, "b 3"] = start[edge] + (part / count[edge])[:, None] * along[edge]
    return points


def upright(plane: Plane) -> Plane:
    """Returns a plane, or a batch of them, turned to be upright on the sheet."""
    normal = plane.normal * np.array([1.0, 1.0, 0.0])
    length = np.linalg.norm(normal, axis=-1)
    return Plane(normal / length[..., None], plane.offset / length)


def uncertainty_in_space(uncertainty: Uncertainty, plane: Plane, sheet: Sheet) -> Uncertainty:
    """Completes the uncertainty of a plane that was estimated from an outline.

    The standard error of the sheet's own plane, on which the mirror plane stands upright, is added. It is the error of
    the slope of a regression of the heights on the position along the normal of the mirror plane.

    Args:
        uncertainty: uncertainty of the plane within the sheet.
        plane: the mirror plane.
        sheet: the flat cloud.
    """
    along = sheet.whole.points @ plane.normal
    variance = sheet.noise**2 / (float(((along - along.mean()) ** 2).sum()) + 1e-300)
    tilt = np.append(uncertainty.tangents[:, 2], 0.0)
    return uncertainty._replace(covariance=uncertainty.covariance + variance * np.outer(tilt, tilt))
