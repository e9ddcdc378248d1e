"""Nearest neighbours of the mirror image and the least-squares plane in turn, after 3DSymm.

After R. Nagar and S. Raman, *3DSymm: Robust and Accurate 3D Reflection Symmetry Detection*, Pattern Recognition 107,
2020. Theirs: every round takes the nearest neighbour of every mirror image and then the plane of least squares, with
no pair left out. How they begin is not known to us, so both starts are our choice: "pca" is three planes,
"half-sphere" 26. Ours too are the thinning, the limits of the rounds, and the ranking by what is left of their cost.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import Frame, framed, reflect
from experiments.baselines.least_squares import least_squares
from experiments.baselines.pca import principal_axes
from experiments.metrics.ranking import Ranking, distinct, plane_distance
from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane

NUM_DIRECTIONS = 26
"""No direction is then further than 23 degrees from one of them."""

APART = 0.1
"""Starts that end nearer to each other than this have found one plane."""

Match = Callable[[Float[np.ndarray, "n 3"]], Float[np.ndarray, "n 3"]]
"""Gives the points of the cloud that mirror images are matched with."""


@dataclass(frozen=True, kw_only=True)
class ThreeDSymm(Baseline):
    """The distinct planes that the starts end in.

    They are ranked by minus the root mean square distance of mirror images from the cloud, in mean radii.

    Attributes:
        starts: planes through the mean to begin with: "pca", the three principal ones, or "half-sphere", 26 of a
            Fibonacci spiral.
        most: points that are kept of a larger cloud, drawn at random.
        steps: most rounds from a start.
        tol: distance of two planes (see `plane_distance`) at which a start has converged.
    """

    name: ClassVar[str] = "3dsymm"

    starts: Literal["pca", "half-sphere"] = "pca"
    most: int = 5000
    steps: int = 100
    tol: float = 1e-6

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = framed(points, rng, most=self.most)
        directions = {"pca": principal_axes(frame.points), "half-sphere": half_sphere()}[self.starts]
        return ended(frame, directions, nearest(frame.points), steps=self.steps, tol=self.tol)


def ended(
    frame: Frame, directions: Iterable[Float[np.ndarray, " 3"]], match: Match, *, steps: int, tol: float
) -> Ranking:
    """The distinct planes that planes through the mean, given by their normals, end in."""
    planes = [alternate(frame.points, start, 0.0, match, steps=steps, tol=tol) for start in directions]
    normals, offsets = (np.array(part) for part in zip(*planes, strict=True))
    scores = -np.array([residual(frame.points, *plane, match) for plane in planes])
    best = distinct(normals, offsets, scores, apart=APART, most=len(planes))
    return frame.ranking(normals[best], offsets[best], scores[best])


def alternate(
    points: Float[np.ndarray, "n 3"],
    normal: Float[np.ndarray, " 3"],
    offset: float,
    match: Match,
    *,
    steps: int = 100,
    tol: float = 1e-6,
) -> tuple[Float[np.ndarray, " 3"], float]:
    """Where matching and least squares in turn take a plane.

    Args:
        points: the cloud, of mean radius about 1.
        normal: unit normal of the plane to begin with.
        offset: its offset.
        match: gives the partners of mirror images.
        steps: most rounds.
        tol: distance of two planes at which it stops.

    Returns:
        Unit normal and offset.
    """
    for _ in range(steps):
        found = least_squares(points, match(reflect(normal, offset, points)))
        moved = plane_distance(Plane(normal[None], np.array([offset])), Plane(found[0], np.asarray(found[1])))[0]
        normal, offset = found
        if moved < tol:
            break
    return normal, offset


def residual(points: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, " 3"], offset: float, match: Match) -> float:
    """Root mean square distance of mirror images from their partners: of the cost that the rounds never raise."""
    image = reflect(normal, offset, points)
    return float(np.sqrt(((image - match(image)) ** 2).sum(axis=1).mean()))


def nearest(points: Float[np.ndarray, "n 3"]) -> Match:
    """Matches mirror images with the nearest points of a cloud."""
    tree = KDTree(points)
    return lambda image: points[tree.query(image)[1]]


def half_sphere() -> Float[np.ndarray, "26 3"]:
    """Directions spread evenly over the half sphere: v and −v are the same mirror."""
    return fibonacci(NUM_DIRECTIONS)
