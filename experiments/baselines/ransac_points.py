"""RANSAC on points: two random points define a plane, and points vote for it if their mirror images meet the cloud.

The organisers of C. Funk et al., *2017 ICCV Challenge: Detecting Symmetry in the Wild*, released it as the baseline for
global symmetries (`Andreiush/3DsymChallengeICCV17`). Corrected here:

- The plane passes through the mid-point of its two points, not through p1 + (p1 − p2)/2.
- Planes are distinct if they differ in angle or offset; the program compares angles alone.
- The radius bounds distances, not their squares. It is relative to the longest principal side; the program takes the
  extent along the x axis, which depends on the pose.

`RansacOnPoints.as_released` has the program's parameters and its stopping rule: it stops when two inliers would have
been drawn with probability 95 %. But two inliers are rarely mirror images of each other, so that only six or seven
planes are drawn, and two to four of 100 generated objects come out right. By default more planes are drawn, and the
best are refitted.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import make_frame, reflect
from experiments.baselines.least_squares import least_squares
from experiments.baselines.pca import principal_axes
from experiments.metrics.ranking import Ranking, distinct
from symjax.geometry.plane import Plane

RADIUS = 0.03
"""Smaller than the program's 0.05, within which nearly every mirror image meets a cloud with many outliers.

The normal was within 5 degrees on 17 % (0.05) and 74 % (0.03) of generated clouds with as many outliers as points, and
on 99 % and 97 % of clean clouds.
"""

APART = 0.1
"""Planes with a smaller distance count as one (`plane_distance`; in radians between planes through the mean)."""

MIN_RATIO = 0.1
"""Planes with a smaller share of votes are dropped, except the best."""

BATCH = 20
"""Number of planes that are voted on at once; votes beyond the draw at which RANSAC stops are wasted."""

MIN_INLIERS = 3
"""Fewer pairs than this are not refitted: one outlier among them would decide the plane."""


@dataclass(frozen=True, kw_only=True)
class RansacOnPoints(Baseline):
    """The distinct planes that map most of a cloud onto itself; the score is the share of mirror images that meet it.

    Attributes:
        max_points: number of points to which a larger cloud is thinned at random.
        radius: distance within which a mirror image meets the cloud, over the longest principal side.
        max_draws: largest number of planes that are drawn.
        confidence: probability of having drawn two inliers at which drawing stops; None: `max_draws` planes are drawn.
        voters: number of points that vote on drawn planes; None: all. All points vote on the planes that are kept.
        refits: number of least-squares refits to the inliers and their nearest neighbours.
        max_planes: largest number of planes that are returned.
    """

    name: ClassVar[str] = "ransac-points"
    accepts_all: ClassVar[bool] = True

    max_points: int = 2000
    radius: float = RADIUS
    max_draws: int = 5000
    confidence: float | None = None
    voters: int | None = 300
    refits: int = 10
    max_planes: int = 3

    @classmethod
    def as_released(cls) -> "RansacOnPoints":
        """Returns the baseline with the stopping rule and the parameters of the organisers' program."""
        return cls(radius=0.05, confidence=0.95, max_draws=1000, voters=None, refits=0)

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = make_frame(points, rng, max_points=self.max_points)
        tree = KDTree(frame.points)
        reach = self.radius * float(np.ptp(frame.points @ principal_axes(frame.points).T, axis=0).max())
        voters = frame.points[rng.permutation(len(frame.points))[: self.voters]]
        normals, offsets = draw_planes(frame.points, self.max_draws, rng)
        ratios = vote_until_confident(normals, offsets, voters, tree, reach, self.confidence)
        best = distinct(normals[: len(ratios)], offsets[: len(ratios)], ratios, apart=APART, most=self.max_planes)
        fitted = [refit(normals[k], offsets[k], tree, reach, self.refits) for k in best]
        normals, offsets = (np.array(part) for part in zip(*fitted, strict=True))
        ratios = vote_ratios(normals, offsets, frame.points, tree, reach)
        best = distinct(normals, offsets, ratios, apart=APART, most=self.max_planes)
        best = best[(ratios[best] >= MIN_RATIO) | (np.arange(len(best)) == 0)]
        return frame.ranking(normals[best], offsets[best], ratios[best])


def draw_planes(
    points: Float[np.ndarray, "m 3"], num_draws: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "k 3"], Float[np.ndarray, " k"]]:
    """Draws pairs of points and returns the planes that exchange them; pairs of coincident points are skipped."""
    first, second = points[rng.integers(len(points), size=(2, num_draws))]
    length = np.linalg.norm(second - first, axis=1)
    first, second, length = first[length > 0], second[length > 0], length[length > 0]
    normals = (second - first) / length[:, None]
    return normals, (normals * (first + second) / 2).sum(axis=1)


def vote_until_confident(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    voters: Float[np.ndarray, "j 3"],
    tree: KDTree,
    radius: float,
    confidence: float | None,
) -> Float[np.ndarray, " i"]:
    """Returns the vote ratios of the planes in the order of the draws, up to the draw at which RANSAC stops."""
    ratios = np.empty(0)
    for first in range(0, len(normals), BATCH):
        rows = slice(first, first + BATCH)
        ratios = np.append(ratios, vote_ratios(normals[rows], offsets[rows], voters, tree, radius))
        end = None if confidence is None else num_draws_needed(ratios, confidence)
        if end is not None:
            return ratios[:end]
    return ratios


def vote_ratios(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    voters: Float[np.ndarray, "j 3"],
    tree: KDTree,
    radius: float,
) -> Float[np.ndarray, " k"]:
    """Returns, for every plane, the share of the voters whose mirror images lie within the radius of the cloud."""
    images = np.asarray(Plane(normals, offsets).reflect(voters))
    ratios: Float[np.ndarray, " k"] = np.isfinite(tree.query(images, distance_upper_bound=radius)[0]).mean(axis=1)
    return ratios


def num_draws_needed(ratios: Float[np.ndarray, " k"], confidence: float) -> int | None:
    """Returns the number of draws after which RANSAC stops, or None if more than these are needed.

    It stops when two inliers of the best plane so far would have been drawn with this confidence.
    """
    both = np.clip(np.maximum.accumulate(ratios) ** 2, 1e-12, 1 - 1e-12)
    enough = np.log(1 - confidence) / np.log(1 - both) <= np.arange(1, len(ratios) + 1)
    return int(np.argmax(enough)) + 1 if enough.any() else None


def refit(
    normal: Float[np.ndarray, " 3"], offset: float, tree: KDTree, radius: float, repeats: int
) -> tuple[Float[np.ndarray, " 3"], float]:
    """Fits the plane to inliers and their nearest neighbours, `repeats` times; stops early if inliers are too few."""
    points = tree.data
    for _ in range(repeats):
        distance, row = tree.query(reflect(normal, offset, points))
        inlier = distance < radius
        if np.count_nonzero(inlier) < MIN_INLIERS:
            break
        normal, offset = least_squares(points[inlier], points[row[inlier]])
    return normal, offset
