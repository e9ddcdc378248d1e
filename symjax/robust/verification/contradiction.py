"""Contradiction: mirror images that lie where the object has no surface.

The score compares the reflected cloud with the cloud at a fine scale, where noise and curvature decide. A handle of a
mug is a small fraction of its points, and loses against the body. Coarse evidence is unambiguous: the mirror image of
the handle lies many spacings away from any surface. A missing part produces such images too, but then they begin at the
boundary of the surface, where the part was cut off, or lie in space that the scan could not see.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from symjax.geometry.plane import Plane
from symjax.robust.surface import Surface
from symjax.robust.verification.scoring import PlaneScore, displacement_weight

FAR_SPACINGS, FAR_TOLERANCES = 4.0, 2.5
"""Distance from the nearest point, in spacings and in tolerances of the surface, beyond which a mirror image is far
from the surface: neither random sampling nor noise explains it. The larger of the two counts."""

CONFIDENT = 0.05
"""Point confidence below which a point is an outlier, whose mirror image contradicts nothing."""

EMPTY = 0.9
"""Non-match penalty above which a scan from one side saw empty space at a mirror image."""

EXCUSED_BY_BOUNDARY, EXCUSED_BY_OUTLINE = 0.2, 0.6
"""Fraction of the boundary points, among the surface points nearest to a cluster of far mirror images, above which a
missing part explains the cluster. The second one is for scans from one side, whose outline is boundary everywhere.
Measured with the right plane: 0.24 and more on cut objects; with the best plane of complete objects without a symmetry
0 to 0.2."""


MAX_COMPLETED, NUM_REFLECTED = 60_000, 4000
"""Maximum number of points of a completed cloud, and number of them that are reflected: enough for a fraction."""


class Contradiction(NamedTuple):
    """How strongly a cloud contradicts a plane at a coarse scale.

    Attributes:
        gross: fraction of the weight whose mirror images are far from the surface, for whatever reason.
        refuting: the part of it that no missing part explains.
        at_boundary: fraction of boundary points among the surface points nearest to the clusters of far mirror images,
            in the mean over all clusters; 1 without any.
    """

    gross: float
    refuting: float
    at_boundary: float


NO_CONTRADICTION = Contradiction(0.0, 0.0, 1.0)


def contradiction(
    plane: Plane, surface: Surface, scored: PlaneScore, *, one_sided: bool, excused: float | None = None
) -> Contradiction:
    """Measures how strongly a cloud contradicts a plane at a coarse scale.

    Far mirror images that lie close together form a cluster. A cluster is excused as a whole, because a mirror image
    inside a large hole is far from the boundary of the hole too.

    Args:
        plane: the plane.
        surface: the surface, in units of its diagonal.
        scored: score of the plane on all points of the surface.
        one_sided: whether the cloud is a scan from one side.
        excused: fraction of boundary points above which a cluster is excused; None for the default.
    """
    if excused is None:
        excused = EXCUSED_BY_OUTLINE if one_sided else EXCUSED_BY_BOUNDARY
    limit = far_distance(surface)
    far = (scored.distance > limit) & (surface.confidence > CONFIDENT)
    total = float(scored.weight.sum()) + 1e-12
    gross = float(scored.weight[far].sum()) / total
    if not gross:
        return NO_CONTRADICTION
    cluster = _clusters(np.asarray(plane.reflect(surface.points[far])), limit)
    beside = scored.distance[far] < 2 * limit
    boundary = _mean_by(cluster, surface.boundary[scored.partner[far]], beside)
    counting = (boundary < excused)[cluster]
    if one_sided:
        counting &= scored.penalty[far] > EMPTY
    refuting = float(scored.weight[far][counting].sum()) / total
    return Contradiction(gross, refuting, float(np.average(boundary[cluster], weights=scored.weight[far])))


class Completion(NamedTuple):
    """A cloud together with its mirror images.

    If a plane is right, then the cloud that it completes lacks less than the cloud, and a further mirror plane has
    fewer excuses.

    Attributes:
        surface: the surface of the cloud, in units of its diagonal.
        points: the points of the cloud and their mirror images.
        confidence: confidence of each.
    """

    surface: Surface
    points: Float[np.ndarray, "n 3"]
    confidence: Float[np.ndarray, " n"]

    def add(self, plane: Plane) -> "Completion":
        """Returns the completion with the mirror images of all its points in one more plane."""
        points = np.concatenate([self.points, np.asarray(plane.reflect(self.points))])
        confidence = np.tile(self.confidence, 2)
        if len(points) > MAX_COMPLETED:
            kept = np.random.default_rng(0).choice(len(points), MAX_COMPLETED, replace=False)
            points, confidence = points[kept], confidence[kept]
        return Completion(self.surface, points, confidence)

    def contradiction(self, plane: Plane) -> float:
        """Returns the gross contradiction between the completed cloud and a plane."""
        rows = slice(None, None, max(1, len(self.points) // NUM_REFLECTED))
        points = self.points[rows]
        distance, _ = cKDTree(self.points).query(np.asarray(plane.reflect(points)), workers=-1)
        weight = self.confidence[rows] * displacement_weight(plane, points, self.surface.spacing)
        return float(weight[distance > far_distance(self.surface)].sum() / (weight.sum() + 1e-12))


def far_distance(surface: Surface) -> float:
    """Returns the distance from the nearest point beyond which a mirror image is far from the surface."""
    return max(FAR_SPACINGS * surface.spacing, FAR_TOLERANCES * surface.tolerance)


def _clusters(points: Float[np.ndarray, "n 3"], cell: float) -> Int[np.ndarray, " n"]:
    """Returns cluster labels from 0 on: points in the same cell or in cells that touch share a cluster."""
    cells, cell_of = np.unique(np.floor(points / cell).astype(int), axis=0, return_inverse=True)
    touching = cKDTree(cells).query_pairs(1.8, output_type="ndarray")  # √3 across a corner, 2 to the next but one
    graph = coo_array((np.ones(len(touching)), touching.T), shape=(len(cells), len(cells)))
    labels: Int[np.ndarray, " n"] = connected_components(graph, directed=False)[1][cell_of.ravel()]
    return labels


def _mean_by(
    label: Int[np.ndarray, " n"], value: Bool[np.ndarray, " n"], selected: Bool[np.ndarray, " n"]
) -> Float[np.ndarray, " k"]:
    """Returns the mean of the selected values by label, or of all values of a label if none of them is selected."""
    count = label.max() + 1
    chosen = selected | (np.bincount(label[selected], minlength=count) == 0)[label]
    mean: Float[np.ndarray, " k"] = np.bincount(label[chosen], value[chosen], count) / np.bincount(
        label[chosen], minlength=count
    )
    return mean
