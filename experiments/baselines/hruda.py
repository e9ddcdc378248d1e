"""The differentiable symmetry measure of Hruda, Kolingerová and Váša.

After L. Hruda, I. Kolingerová and L. Váša, *Robust, fast and flexible symmetry plane detection based on
differentiable symmetry measure*, The Visual Computer 38, 2022. Theirs: the measure, a sum of Wendland's function over
all pairs of a mirror image and a point, with α = 15 over the mean radius; the cloud averaged in the cells of a grid to
about 1 000 points; candidates halfway between pairs of points, averaged where they are closer than 0.1; the five best
improved by L-BFGS over all four numbers of a plane; planes of at least 70 % of the best measure kept. Ours: that the
candidates come from all pairs of about 100 averaged points, that one is the mean of its members, and that the measure
is divided by that of the identity. Their weights of pairs, for surfaces that have more than points, are left out.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import minimize

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import framed
from experiments.metrics.ranking import Ranking, distinct

REACH = 2.6
"""α d from which on the kernel is zero; there it follows exp(−(α d)²) within 0.02."""

FINEST = 160
"""Cells along the longest axis, at most: one point far away would otherwise make the grid too large to hold."""

BATCH = 64
"""Planes that are measured at a time: their pairs take some tens of MiB."""


class Cells(NamedTuple):
    """A cloud in a grid of cells, each of which lists the points that may be within reach of a place in it.

    Attributes:
        points: the cloud.
        alpha: 1 over the width of the kernel.
        origin: corner of the grid.
        side: of a cell.
        shape: number of cells along the axes.
        first: where the list of a cell begins, and where the last one ends.
        member: the lists, one after the other.
    """

    points: Float[np.ndarray, "n 3"]
    alpha: float
    origin: Float[np.ndarray, " 3"]
    side: float
    shape: Int[np.ndarray, " 3"]
    first: Int[np.ndarray, " cells+1"]
    member: Int[np.ndarray, " entries"]

    def pairs(self, places: Float[np.ndarray, "m 3"]) -> tuple[Int[np.ndarray, " p"], Float[np.ndarray, "p 3"]]:
        """All pairs of a place and a point within reach of it, and some beyond: which place, and place minus point."""
        at = np.floor((places - self.origin) / self.side).astype(int)
        rows = np.flatnonzero(((at >= 0) & (at < self.shape)).all(axis=1))
        cell = np.ravel_multi_index(tuple(at[rows].T), tuple(self.shape))
        count = self.first[cell + 1] - self.first[cell]
        skipped = np.repeat(self.first[cell] - np.cumsum(count) + count, count)
        rows, members = np.repeat(rows, count), self.member[skipped + np.arange(len(skipped))]
        return rows, places[rows] - self.points[members]


@dataclass(frozen=True, kw_only=True)
class Hruda(Baseline):
    """The planes of the greatest measure, by that over the measure of the identity.

    Attributes:
        alpha: 1 over the width of the kernel, in 1 over mean radii.
        num_points: about so many averaged points are measured.
        num_coarse: about so many averaged points give the candidates.
        apart: distance (see `plane_distance`) below which candidates, and answers, are one.
        starts: candidates that are improved.
        share: of the best measure that an answer has at least.
    """

    name: ClassVar[str] = "hruda"
    several: ClassVar[bool] = True

    alpha: float = 15.0
    num_points: int = 1000
    num_coarse: int = 100
    apart: float = 0.1
    starts: int = 5
    share: float = 0.7

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`; orders the pairs that become candidates at random."""
        frame = framed(points, rng, most=len(points))
        planes = candidates(averaged(frame.points, self.num_coarse), rng, self.apart)
        grid = cells(averaged(frame.points, self.num_points), self.alpha)
        first = np.argsort(-measure(grid, planes), kind="stable")[: self.starts]
        planes = np.stack([improved(grid, plane) for plane in planes[first]])
        identity = kernel(grid.pairs(grid.points)[1], self.alpha).sum()
        normals, offsets, scores = planes[:, :3], planes[:, 3], measure(grid, planes) / identity
        best = distinct(normals, offsets, scores, apart=self.apart, most=self.starts)
        best = best[scores[best] >= self.share * scores[best[0]]]
        return frame.ranking(normals[best], offsets[best], scores[best])


def kernel(off: Float[np.ndarray, "p 3"], alpha: float) -> Float[np.ndarray, " p"]:
    """Wendland's φ = (1 − u)⁵(8u² + 5u + 1) with u = α‖off‖/2.6, zero from u = 1 on: twice differentiable."""
    u = np.minimum(alpha * np.sqrt(np.einsum("pk,pk->p", off, off)) / REACH, 1)
    return (1 - u) ** 5 * (8 * u**2 + 5 * u + 1)


def kernel_gradient(off: Float[np.ndarray, "p 3"], alpha: float) -> Float[np.ndarray, "p 3"]:
    """Its gradient in `off`: φ′/‖off‖ is finite at 0."""
    u = np.minimum(alpha * np.sqrt(np.einsum("pk,pk->p", off, off)) / REACH, 1)
    return (-14 * (alpha / REACH) ** 2 * (1 - u) ** 4 * (4 * u + 1))[:, None] * off


def cells(points: Float[np.ndarray, "n 3"], alpha: float) -> Cells:
    """The grid of a cloud, its cells a quarter of the kernel's reach, or as small as `FINEST` lets them be."""
    reach, extent = REACH / alpha, np.ptp(points, axis=0)
    side = max(reach / 4, extent.max() / FINEST)
    steps = int(np.ceil(reach / side))
    origin = points.min(axis=0) - (steps + 0.5) * side
    shape = np.ceil(extent / side).astype(int) + 2 + 2 * steps
    around = np.stack(np.meshgrid(*[np.arange(-steps, steps + 1)] * 3), axis=-1).reshape(-1, 3)
    at = (np.floor((points - origin) / side).astype(int)[:, None] + around).reshape(-1, 3)
    member = np.repeat(np.arange(len(points)), len(around))
    # a point in reach of a place in a cell is at most a reach and half a cell's diagonal from its middle
    middle = origin + (at + 0.5) * side
    near = ((middle - points[member]) ** 2).sum(axis=1) < (reach + side * np.sqrt(3) / 2) ** 2
    cell, member = np.ravel_multi_index(tuple(at[near].T), tuple(shape)), member[near]
    first = np.append(0, np.cumsum(np.bincount(cell, minlength=shape.prod())))
    return Cells(points, alpha, origin, side, shape, first, member[np.argsort(cell, kind="stable")])


def measure(grid: Cells, planes: Float[np.ndarray, "k 4"]) -> Float[np.ndarray, " k"]:
    """The measure Σ_i Σ_j φ(‖r(x_i) − x_j‖) of planes (n, w) with unit normals."""
    sums = []
    for some in np.split(planes, np.arange(BATCH, len(planes), BATCH)):
        along = some[:, :3] @ grid.points.T - some[:, 3:]
        image = (grid.points - 2 * along[..., None] * some[:, None, :3]).reshape(-1, 3)
        rows, off = grid.pairs(image)
        sums.append(np.bincount(rows // len(grid.points), kernel(off, grid.alpha), minlength=len(some)))
    return np.concatenate(sums)


def measure_and_gradient(grid: Cells, z: Float[np.ndarray, " 4"]) -> tuple[float, Float[np.ndarray, " 4"]]:
    """The measure of the plane z / ‖z₁₋₃‖ and its gradient in z."""
    length = np.linalg.norm(z[:3])
    n, w = z[:3] / length, z[3] / length
    along = grid.points @ n - w
    image = grid.points - 2 * np.outer(along, n)
    rows, off = grid.pairs(image)
    pull = kernel_gradient(off, grid.alpha)
    across = pull @ n
    in_n, in_w = -2 * (along[rows] @ pull + across @ grid.points[rows]), 2 * across.sum()
    radial = n @ in_n + w * in_w
    return float(kernel(off, grid.alpha).sum()), np.append(in_n - radial * n, in_w) / length


def improved(grid: Cells, plane: Float[np.ndarray, " 4"]) -> Float[np.ndarray, " 4"]:
    """The plane of a local maximum of the measure, by L-BFGS over all four numbers."""

    def loss(z: Float[np.ndarray, " 4"]) -> tuple[float, Float[np.ndarray, " 4"]]:
        value, gradient = measure_and_gradient(grid, z)
        return -value / len(grid.points), -gradient / len(grid.points)

    z = minimize(loss, plane, jac=True, method="L-BFGS-B").x
    return z / np.linalg.norm(z[:3])


def averaged(points: Float[np.ndarray, "n 3"], number: int) -> Float[np.ndarray, "m 3"]:
    """The means of the points in the cells of a grid of which about `number` are occupied; fewer points as they are."""
    if len(points) <= number:
        return points
    finer, coarser = np.ptp(points, axis=0).max() / np.array([number, 1])
    for _ in range(10):
        side = np.sqrt(finer * coarser)
        finer, coarser = (side, coarser) if occupied(points, side).max() >= number else (finer, side)
    count = np.bincount(cell := occupied(points, coarser))
    return np.stack([np.bincount(cell, column) for column in points.T], axis=1) / count[:, None]


def occupied(points: Float[np.ndarray, "n 3"], side: float) -> Int[np.ndarray, " n"]:
    """The cell of every point, the occupied ones counted from 0."""
    at = np.floor((points - points.min(axis=0)) / side).astype(int)
    return np.unique(np.ravel_multi_index(tuple(at.T), tuple(at.max(axis=0) + 1)), return_inverse=True)[1]


def candidates(points: Float[np.ndarray, "n 3"], rng: np.random.Generator, apart: float) -> Float[np.ndarray, "k 4"]:
    """Planes halfway between all pairs of points; one that is nearer than `apart` to another joins its mean."""
    i, j = np.triu_indices(len(points), 1)
    step, middle = points[j] - points[i], (points[i] + points[j]) / 2
    different = step.any(axis=1)
    normals = step[different] / np.linalg.norm(step[different], axis=1, keepdims=True)
    offsets = (middle[different] * normals).sum(axis=1)
    sums, planes, kept = np.empty((len(offsets), 4)), np.empty((len(offsets), 4)), 0
    for plane in rng.permutation(np.column_stack([normals, offsets])):
        along = planes[:kept] @ plane
        # min(|p − q|, |p + q|)² = |p|² + |q|² − 2|p·q|
        square = (planes[:kept] ** 2).sum(axis=1) + plane @ plane - 2 * np.abs(along)
        k = int(square.argmin()) if kept and square.min() < apart**2 else kept
        sums[k] = sums[k] + np.copysign(1, along[k]) * plane if k < kept else plane
        planes[k] = sums[k] / np.linalg.norm(sums[k, :3])
        kept = max(kept, k + 1)
    return planes[:kept]
