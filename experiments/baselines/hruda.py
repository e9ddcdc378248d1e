"""Maximisation of the differentiable symmetry measure of Hruda, Kolingerová and Váša.

After L. Hruda, I. Kolingerová and L. Váša, *Robust, fast and flexible symmetry plane detection based on
differentiable symmetry measure*, The Visual Computer 38, 2022. As published:

- The measure is a sum of Wendland's function over all pairs of a mirror image and a point, with α = 15 over the mean
  radius.
- The cloud is averaged in the cells of a grid to about 1 000 points.
- Candidates lie halfway between pairs of points; candidates closer than 0.1 are averaged.
- L-BFGS improves the five best candidates, over all four numbers of a plane.
- Planes with at least 70 % of the best measure are kept.

Ours: candidates come from all pairs of about 100 averaged points, an averaged candidate is the mean of its members, and
the measure is divided by that of the identity. The authors' weights of pairs are omitted, because they need more than
the points of a surface.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float, Int
from scipy.optimize import minimize

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import make_frame
from experiments.metrics.ranking import Ranking, distinct

REACH = 2.6
"""Value of α d beyond which the kernel is 0. With it the kernel differs from exp(−(α d)²) by less than 0.02."""

FINEST = 160
"""Largest number of cells along the longest axis; without a limit, one distant point would exhaust the memory."""

BATCH = 64
"""Number of planes that are measured at once; their pairs take some tens of MiB."""


class CellLists(NamedTuple):
    """A grid over a cloud; every cell lists the points that may be within the reach of the kernel from inside the cell.

    Attributes:
        points: the cloud.
        alpha: 1 over the width of the kernel.
        origin: corner of the grid.
        side: side of a cell.
        shape: number of cells along each axis.
        first: index in `member` at which the list of each cell begins, and the index at which the last list ends.
        member: indices of points: the lists of all cells, concatenated.
    """

    points: Float[np.ndarray, "n 3"]
    alpha: float
    origin: Float[np.ndarray, " 3"]
    side: float
    shape: Int[np.ndarray, " 3"]
    first: Int[np.ndarray, " cells+1"]
    member: Int[np.ndarray, " entries"]

    def pairs(self, queries: Float[np.ndarray, "m 3"]) -> tuple[Int[np.ndarray, " p"], Float[np.ndarray, "p 3"]]:
        """Finds all pairs of a query and a point within the reach of the kernel, and some pairs beyond it.

        Returns:
            Index of the query, and query minus point, of every pair.
        """
        index = np.floor((queries - self.origin) / self.side).astype(int)
        rows = np.flatnonzero(((index >= 0) & (index < self.shape)).all(axis=1))
        cell = np.ravel_multi_index(tuple(index[rows].T), tuple(self.shape))
        count = self.first[cell + 1] - self.first[cell]
        shift = np.repeat(self.first[cell] - np.cumsum(count) + count, count)
        rows, members = np.repeat(rows, count), self.member[shift + np.arange(len(shift))]
        return rows, queries[rows] - self.points[members]


@dataclass(frozen=True, kw_only=True)
class Hruda(Baseline):
    """The planes of the largest symmetry measure; the score is the measure over that of the identity.

    Attributes:
        alpha: 1 over the width of the kernel, in units of 1 / mean radius.
        num_points: approximate number of averaged points that the measure is computed on.
        num_coarse: approximate number of averaged points that candidates are made from.
        apart: candidates, and returned planes, with a smaller distance count as one (`plane_distance`).
        starts: number of candidates that L-BFGS improves.
        share: least measure of a returned plane, over the best measure.
    """

    name: ClassVar[str] = "hruda"
    accepts_all: ClassVar[bool] = True

    alpha: float = 15.0
    num_points: int = 1000
    num_coarse: int = 100
    apart: float = 0.1
    starts: int = 5
    share: float = 0.7

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`; `rng` orders the pairs that become candidates."""
        frame = make_frame(points, rng, max_points=len(points))
        planes = candidates(grid_means(frame.points, self.num_coarse), rng, self.apart)
        grid = cell_lists(grid_means(frame.points, self.num_points), self.alpha)
        first = np.argsort(-measure(grid, planes), kind="stable")[: self.starts]
        planes = np.stack([maximise(grid, plane) for plane in planes[first]])
        identity = kernel(grid.pairs(grid.points)[1], self.alpha).sum()
        normals, offsets, scores = planes[:, :3], planes[:, 3], measure(grid, planes) / identity
        best = distinct(normals, offsets, scores, apart=self.apart, most=self.starts)
        best = best[scores[best] >= self.share * scores[best[0]]]
        return frame.ranking(normals[best], offsets[best], scores[best])


def kernel(off: Float[np.ndarray, "p 3"], alpha: float) -> Float[np.ndarray, " p"]:
    """Computes Wendland's function φ = (1 − u)⁵(8u² + 5u + 1), u = α‖off‖/2.6; 0 for u ≥ 1, twice differentiable."""
    u = np.minimum(alpha * np.sqrt(np.einsum("pk,pk->p", off, off)) / REACH, 1)
    value: Float[np.ndarray, " p"] = (1 - u) ** 5 * (8 * u**2 + 5 * u + 1)
    return value


def kernel_gradient(off: Float[np.ndarray, "p 3"], alpha: float) -> Float[np.ndarray, "p 3"]:
    """Computes the gradient of `kernel` with respect to `off`; φ′/‖off‖ is finite at 0."""
    u = np.minimum(alpha * np.sqrt(np.einsum("pk,pk->p", off, off)) / REACH, 1)
    factor = -14 * (alpha / REACH) ** 2 * (1 - u) ** 4 * (4 * u + 1)
    gradient: Float[np.ndarray, "p 3"] = factor[:, None] * off
    return gradient


def cell_lists(points: Float[np.ndarray, "n 3"], alpha: float) -> CellLists:
    """Builds the cell lists of a cloud; the side of a cell is a quarter of the kernel's reach, if `FINEST` permits."""
    reach, extent = REACH / alpha, np.ptp(points, axis=0)
    side = max(reach / 4, extent.max() / FINEST)
    steps = int(np.ceil(reach / side))
    origin = points.min(axis=0) - (steps + 0.5) * side
    shape = np.ceil(extent / side).astype(int) + 2 + 2 * steps
    around = np.stack(np.meshgrid(*[np.arange(-steps, steps + 1)] * 3), axis=-1).reshape(-1, 3)
    index = (np.floor((points - origin) / side).astype(int)[:, None] + around).reshape(-1, 3)
    member = np.repeat(np.arange(len(points)), len(around))
    # a point within reach of a query in a cell is at most the reach plus half a diagonal from the centre of the cell
    middle = origin + (index + 0.5) * side
    near = ((middle - points[member]) ** 2).sum(axis=1) < (reach + side * np.sqrt(3) / 2) ** 2
    cell, member = np.ravel_multi_index(tuple(index[near].T), tuple(shape)), member[near]
    first = np.append(0, np.cumsum(np.bincount(cell, minlength=shape.prod())))
    return CellLists(points, alpha, origin, side, shape, first, member[np.argsort(cell, kind="stable")])


def measure(grid: CellLists, planes: Float[np.ndarray, "k 4"]) -> Float[np.ndarray, " k"]:
    """Computes the measure Σ_i Σ_j φ(‖r(x_i) − x_j‖) of planes (n, w) with unit normals."""
    sums = []
    for some in np.split(planes, np.arange(BATCH, len(planes), BATCH)):
        along = some[:, :3] @ grid.points.T - some[:, 3:]
        image = (grid.points - 2 * along[..., None] * some[:, None, :3]).reshape(-1, 3)
        rows, off = grid.pairs(image)
        sums.append(np.bincount(rows // len(grid.points), kernel(off, grid.alpha), minlength=len(some)))
    return np.concatenate(sums)


def measure_and_gradient(grid: CellLists, z: Float[np.ndarray, " 4"]) -> tuple[float, Float[np.ndarray, " 4"]]:
    """Computes the measure of the plane z / ‖z₁₋₃‖, and its gradient with respect to z."""
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


def maximise(grid: CellLists, plane: Float[np.ndarray, " 4"]) -> Float[np.ndarray, " 4"]:
    """Moves a plane to a local maximum of the measure by L-BFGS."""

    def loss(z: Float[np.ndarray, " 4"]) -> tuple[float, Float[np.ndarray, " 4"]]:
        value, gradient = measure_and_gradient(grid, z)
        return -value / len(grid.points), -gradient / len(grid.points)

    z = minimize(loss, plane, jac=True, method="L-BFGS-B").x
    maximum: Float[np.ndarray, " 4"] = z / np.linalg.norm(z[:3])
    return maximum


def grid_means(points: Float[np.ndarray, "n 3"], number: int) -> Float[np.ndarray, "m 3"]:
    """Averages points in the cells of a grid with about `number` occupied cells; returns fewer points unchanged."""
    if len(points) <= number:
        return points
    finer, coarser = np.ptp(points, axis=0).max() / np.array([number, 1])
    for _ in range(10):
        side = np.sqrt(finer * coarser)
        finer, coarser = (side, coarser) if occupied_cells(points, side).max() >= number else (finer, side)
    count = np.bincount(cell := occupied_cells(points, coarser))
    return np.stack([np.bincount(cell, column) for column in points.T], axis=1) / count[:, None]


def occupied_cells(points: Float[np.ndarray, "n 3"], side: float) -> Int[np.ndarray, " n"]:
    """Returns the number of every point's cell; only occupied cells are numbered, from 0."""
    index = np.floor((points - points.min(axis=0)) / side).astype(int)
    cell = np.ravel_multi_index(tuple(index.T), tuple(index.max(axis=0) + 1))
    return np.unique(cell, return_inverse=True)[1]


def candidates(points: Float[np.ndarray, "n 3"], rng: np.random.Generator, apart: float) -> Float[np.ndarray, "k 4"]:
    """Returns the planes halfway between all pairs of points; planes closer than `apart` are replaced by their mean."""
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
