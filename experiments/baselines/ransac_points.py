"""RANSAC over bare points: two points drawn at random make a plane, mirror images that meet the cloud vote.

The baseline for global symmetries that the organisers of C. Funk et al., *2017 ICCV Challenge: Detecting Symmetry in
the Wild*, released (`Andreiush/3DsymChallengeICCV17`). Corrected here: the plane goes through the mid-point of its two
points and not through p1 + (p1 − p2)/2; planes are told apart by angle and offset and not by angle alone; the radius is
one of distances and not of their squares, and of the longest principal side and not of the x axis, which turns with the
pose.

Theirs are also the parameters of `as_released`. They stop when two inliers would have
been drawn with 95 %; but two inliers are seldom each other's mirror image, so that six or seven planes are drawn, and
of 100 generated objects two to four are right. By default more are drawn, and the best are refitted.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import framed, reflect
from experiments.baselines.least_squares import least_squares
from experiments.baselines.pca import principal_axes
from experiments.metrics.ranking import Ranking, distinct
from symjax.geometry.plane import Plane

RADIUS = 0.03
"""Theirs is 0.05, within which nearly every image meets a cloud with many outliers: of generated clouds with as many
outliers as points, 17 % were within 5 degrees with 0.05 and 74 % with 0.03; of clean ones, 99 % and 97 %."""

APART = 0.1
"""Planes nearer than this (see `plane_distance`; between planes through the mean, radians) are one."""

LEAST_RATIO = 0.1
"""Planes with a lower share of votes are left out, but for the best."""

BATCH = 20
"""Planes voted on at once: what is drawn after the end was not asked for."""

MIN_INLIERS = 3
"""Fewer pairs do not fix a plane against one outlier."""


@dataclass(frozen=True, kw_only=True)
class RansacOnPoints(Baseline):
    """The planes that mirror most of a cloud onto the cloud: distinct ones by the share of images that meet it.

    Attributes:
        most: points that are kept of a larger cloud.
        radius: distance of a mirror image from the cloud within which it votes, in longest principal sides.
        draws: most planes that are drawn.
        confidence: of having drawn two inliers, at which drawing ends; None draws all.
        voters: points that vote on what is drawn; None is all. All vote on the planes that are kept.
        refits: least-squares fits to inliers and their nearest points that follow.
        planes: planes that are kept.
    """

    name: ClassVar[str] = "ransac-points"
    several: ClassVar[bool] = True

    most: int = 2000
    radius: float = RADIUS
    draws: int = 5000
    confidence: float | None = None
    voters: int | None = 300
    refits: int = 10
    planes: int = 3

    @classmethod
    def as_released(cls) -> "RansacOnPoints":
        """With the stopping rule and the parameters of the organisers' program."""
        return cls(radius=0.05, confidence=0.95, draws=1000, voters=None, refits=0)

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`.

        Draws the points that are kept, those that vote first, and those that make planes.
        """
        frame = framed(points, rng, most=self.most)
        tree = KDTree(frame.points)
        reach = self.radius * float(np.ptp(frame.points @ principal_axes(frame.points).T, axis=0).max())
        voters = frame.points[rng.permutation(len(frame.points))[: self.voters]]
        normals, offsets = drawn(frame.points, self.draws, rng)
        ratios = voted(normals, offsets, voters, tree, reach, self.confidence)
        best = distinct(normals[: len(ratios)], offsets[: len(ratios)], ratios, apart=APART, most=self.planes)
        fitted = [refit(normals[k], offsets[k], tree, reach, self.refits) for k in best]
        normals, offsets = (np.array(part) for part in zip(*fitted, strict=True))
        ratios = votes(normals, offsets, frame.points, tree, reach)
        best = distinct(normals, offsets, ratios, apart=APART, most=self.planes)
        best = best[(ratios[best] >= LEAST_RATIO) | (np.arange(len(best)) == 0)]
        return frame.ranking(normals[best], offsets[best], ratios[best])


def drawn(
    points: Float[np.ndarray, "m 3"], draws: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "k 3"], Float[np.ndarray, " k"]]:
    """Normals and offsets of the planes half-way between two points drawn at random; none where they coincide."""
    first, second = points[rng.integers(len(points), size=(2, draws))]
    length = np.linalg.norm(second - first, axis=1)
    first, second, length = first[length > 0], second[length > 0], length[length > 0]
    normals = (second - first) / length[:, None]
    return normals, (normals * (first + second) / 2).sum(axis=1)


def voted(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    voters: Float[np.ndarray, "j 3"],
    tree: KDTree,
    radius: float,
    confidence: float | None,
) -> Float[np.ndarray, " i"]:
    """Votes on the planes in the order they were drawn, as many as are drawn."""
    ratios = np.empty(0)
    for first in range(0, len(normals), BATCH):
        rows = slice(first, first + BATCH)
        ratios = np.append(ratios, votes(normals[rows], offsets[rows], voters, tree, radius))
        end = None if confidence is None else stopping(ratios, confidence)
        if end is not None:
            return ratios[:end]
    return ratios


def votes(
    normals: Float[np.ndarray, "k 3"],
    offsets: Float[np.ndarray, " k"],
    voters: Float[np.ndarray, "j 3"],
    tree: KDTree,
    radius: float,
) -> Float[np.ndarray, " k"]:
    """Share of the voters whose mirror images lie within the radius of the cloud."""
    images = np.asarray(Plane(normals, offsets).reflect(voters))
    return np.isfinite(tree.query(images, distance_upper_bound=radius)[0]).mean(axis=1)


def stopping(ratios: Float[np.ndarray, " k"], confidence: float) -> int | None:
    """After how many draws two inliers of the best plane so far would have been drawn with this confidence, if any."""
    both = np.clip(np.maximum.accumulate(ratios) ** 2, 1e-12, 1 - 1e-12)
    enough = np.log(1 - confidence) / np.log(1 - both) <= np.arange(1, len(ratios) + 1)
    return int(np.argmax(enough)) + 1 if enough.any() else None


def refit(
    normal: Float[np.ndarray, " 3"], offset: float, tree: KDTree, radius: float, times: int
) -> tuple[Float[np.ndarray, " 3"], float]:
    """The plane of least squares of the inliers and their nearest points, so many times; as it is of too few."""
    points = tree.data
    for _ in range(times):
        distance, row = tree.query(reflect(normal, offset, points))
        inlier = distance < radius
        if np.count_nonzero(inlier) < MIN_INLIERS:
            break
        normal, offset = least_squares(points[inlier], points[row[inlier]])
    return normal, offset
