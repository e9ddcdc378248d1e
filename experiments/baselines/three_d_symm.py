"""Alternation of nearest-neighbour matching and least squares, after 3DSymm.

After R. Nagar and S. Raman, *3DSymm: Robust and Accurate 3D Reflection Symmetry Detection*, Pattern Recognition 107,
2020. As published: every step matches each mirror image with its nearest neighbour, and then fits the least-squares
plane to all pairs. Ours: the starts, because we do not know theirs ("pca": three planes; "half-sphere": 26), the
thinning, the limits on the steps, and the ranking by the remaining cost.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import Frame, make_frame, reflect
from experiments.baselines.least_squares import least_squares
from experiments.baselines.pca import principal_axes
from experiments.metrics.ranking import Ranking, distinct, plane_distance
from symjax.geometry.checks import choice
from symjax.geometry.directions import fibonacci
from symjax.geometry.plane import Plane

NUM_DIRECTIONS = 26
"""With 26 directions, every direction is within 23 degrees of one of them (up to its sign)."""

APART = 0.1
"""Planes with a smaller distance (`plane_distance`) count as one."""

Starts = Literal["pca", "half-sphere"]

Match = Callable[[Float[np.ndarray, "n 3"]], Float[np.ndarray, "n 3"]]
"""A function that returns the point of the cloud that every mirror image is matched with."""


@dataclass(frozen=True, kw_only=True)
class ThreeDSymm(Baseline):
    """The distinct planes that the alternation converges to from several starts.

    The score is minus the root mean square distance of mirror images from the cloud, in mean radii.

    Attributes:
        starts: normals of the starting planes, which pass through the mean: "pca", the three principal axes, or
            "half-sphere", 26 directions of a Fibonacci spiral.
        max_points: number of points to which a larger cloud is thinned at random.
        max_steps: limit on the steps from one start.
        tol: convergence tolerance: distance of the planes of two successive steps (`plane_distance`).
    """

    name: ClassVar[str] = "3dsymm"

    starts: Starts = "pca"
    max_points: int = 5000
    max_steps: int = 100
    tol: float = 1e-6

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        choice("starts", self.starts, get_args(Starts))
        frame = make_frame(points, rng, max_points=self.max_points)
        directions = principal_axes(frame.points) if self.starts == "pca" else half_sphere()
        return alternate_from(directions, frame, nearest(frame.points), max_steps=self.max_steps, tol=self.tol)


def alternate_from(
    directions: Iterable[Float[np.ndarray, " 3"]], frame: Frame, match: Match, *, max_steps: int, tol: float
) -> Ranking:
    """Runs `alternate` from planes through the mean with these normals, and ranks the distinct planes that result."""
    planes = [alternate(frame.points, start, 0.0, match, max_steps=max_steps, tol=tol) for start in directions]
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
    max_steps: int = 100,
    tol: float = 1e-6,
) -> tuple[Float[np.ndarray, " 3"], float]:
    """Improves a plane by matching and least squares in turn.

    Args:
        points: the cloud, of mean radius about 1.
        normal: unit normal of the start.
        offset: offset of the start.
        match: matches mirror images with points of the cloud.
        max_steps: limit on the steps.
        tol: distance of the planes of two successive steps at which the iteration stops.

    Returns:
        Unit normal and offset.
    """
    for _ in range(max_steps):
        found = least_squares(points, match(reflect(normal, offset, points)))
        moved = plane_distance(Plane(normal[None], np.array([offset])), Plane(found[0], np.asarray(found[1])))[0]
        normal, offset = found
        if moved < tol:
            break
    return normal, offset


def residual(points: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, " 3"], offset: float, match: Match) -> float:
    """Returns the root mean square distance of mirror images from their matches; no step increases it."""
    image = reflect(normal, offset, points)
    return float(np.sqrt(((image - match(image)) ** 2).sum(axis=1).mean()))


def nearest(points: Float[np.ndarray, "n 3"]) -> Match:
    """Returns a function that matches mirror images with the nearest points of a cloud."""
    tree = KDTree(points)
    return lambda image: points[tree.query(image)[1]]


def half_sphere() -> Float[np.ndarray, "26 3"]:
    """Returns directions spread evenly over the half sphere; v and −v are normals of the same plane."""
    return fibonacci(NUM_DIRECTIONS)
