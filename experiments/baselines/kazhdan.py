"""The planar reflective symmetry descriptor: the distance of a shape from its mirror images in planes through its mean.

M. Kazhdan, B. Chazelle, D. Dobkin, T. Funkhouser, S. Rusinkiewicz: A Reflective Symmetry Descriptor for 3D Models,
Algorithmica 38, 2004 (first at ECCV 2002). As in the publication, planes that do not pass through the centre of mass
are never found.

As in the authors' program ShapeSPH, half the side of a grid of 64³ voxels is twice the root mean square radius, and the
voxels of the shape within the inscribed ball are compared with the squared distance transform. Ours:

- Sums over voxels, at directions of a Fibonacci spiral; the program correlates spherical harmonics on 64 × 64
  directions.
- A voxel is occupied if it holds a point; the program rasterises triangles.
- Distances are interpolated before they are squared.
- The refinement of the best directions.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt, map_coordinates
from scipy.optimize import minimize

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import make_frame
from experiments.metrics.ranking import Ranking, distinct
from symjax.geometry.directions import fibonacci

RADII = 2.0
"""Half the side of the grid, over the root mean square radius of the cloud (as in ShapeSPH)."""

APART = 10.0
"""Least angle between the normals of two ranked planes, in degrees."""

SIMPLEX = 2.0
"""Side of the initial simplex of the refinement, in degrees: a little less than the spacing of 2 500 directions."""


class Raster(NamedTuple):
    """A shape on a voxel grid, with its centre of mass at the centre of the grid.

    Attributes:
        voxels: centres of the occupied voxels in the ball that the grid contains, relative to the centre, in voxels.
        distance: distance of every voxel from the nearest occupied one, in voxels.
    """

    voxels: Float[np.ndarray, "m 3"]
    distance: Float[np.ndarray, "r r r"]

    def asymmetry(self, normal: Float[np.ndarray, " 3"]) -> float:
        """Returns the mean squared distance (voxels²) of the mirror images of the occupied voxels from the shape."""
        middle = (len(self.distance) - 1) / 2
        images = self.voxels - 2 * np.outer(self.voxels @ normal, normal) + middle
        # distances and not their squares are interpolated: half-way between 0 and 1, squares would give 1/2 instead of
        # 1/4, which favours the mirror planes of the grid
        return float((map_coordinates(self.distance, images.T, order=1, mode="nearest") ** 2).mean())


@dataclass(frozen=True, kw_only=True)
class Kazhdan(Baseline):
    """Planes through the mean, at least 10 degrees apart; the score is minus the mean squared distance in voxels².

    Attributes:
        resolution: number of voxels along a side of the grid.
        num_normals: number of directions on the half sphere.
        max_planes: largest number of planes that are returned.
        refine: whether the best directions are refined to local optima; planes still pass through the mean.
    """

    name: ClassVar[str] = "kazhdan"

    resolution: int = 64
    num_normals: int = 2500
    max_planes: int = 10
    refine: bool = True

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`; `rng` is unused."""
        frame = make_frame(points, rng, max_points=len(points))
        raster = rasterise(frame.points, self.resolution)
        normals, scores = best_normals(raster, fibonacci(self.num_normals), self.max_planes)
        if self.refine:
            normals = np.array([refine_normal(raster, normal) for normal in normals])
            normals, scores = best_normals(raster, normals, self.max_planes)
        return frame.ranking(normals, np.zeros(len(normals)), scores)


def rasterise(points: Float[np.ndarray, "n 3"], resolution: int) -> Raster:
    """Rasterises a centred cloud: a voxel is occupied if it holds a point. Points outside the grid are dropped."""
    half = resolution / 2
    radius = RADII * np.sqrt((points**2).sum(axis=1).mean())
    cells = np.floor(points * (half / radius) + half).astype(int)
    cells = cells[((cells >= 0) & (cells < resolution)).all(axis=1)]
    occupied = np.zeros((resolution,) * 3, bool)
    occupied[tuple(cells.T)] = True
    voxels = np.argwhere(occupied) - (half - 0.5)
    # in the ball, so that all mirror images are on the grid
    inside = np.linalg.norm(voxels, axis=1) <= half - 0.5
    return Raster(voxels[inside], distance_transform_edt(~occupied))


def best_normals(
    raster: Raster, normals: Float[np.ndarray, "k 3"], max_planes: int
) -> tuple[Float[np.ndarray, "j 3"], Float[np.ndarray, " j"]]:
    """Returns the normals that have the best score within 10 degrees, best first, and their scores."""
    scores = -np.array([raster.asymmetry(normal) for normal in normals])
    near = np.abs(normals @ normals.T) > np.cos(np.radians(APART))
    peaks = np.flatnonzero(scores >= np.where(near, scores, -np.inf).max(axis=1))
    # of neighbours with equal scores, keep one
    chord = 2 * np.sin(np.radians(APART) / 2)
    kept = peaks[distinct(normals[peaks], np.zeros(len(peaks)), scores[peaks], apart=chord, most=max_planes)]
    return normals[kept], scores[kept]


def refine_normal(raster: Raster, normal: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """Minimises the asymmetry near a normal by the Nelder-Mead method in the tangent plane."""
    tangents = np.linalg.svd(normal[None])[2][1:]

    def moved(u: Float[np.ndarray, " 2"]) -> Float[np.ndarray, " 3"]:
        unit: Float[np.ndarray, " 3"] = (normal + u @ tangents) / np.sqrt(1 + u @ u)
        return unit

    simplex = np.radians(SIMPLEX) * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    found = minimize(
        lambda u: raster.asymmetry(moved(u)),
        np.zeros(2),
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6},
    )
    return moved(found.x)
