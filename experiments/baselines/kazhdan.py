"""The planar reflective symmetry descriptor: how far a shape is from its mirror image, for each plane through its mean.

M. Kazhdan, B. Chazelle, D. Dobkin, T. Funkhouser, S. Rusinkiewicz: A Reflective Symmetry Descriptor for 3D Models,
Algorithmica 38, 2004 (first at ECCV 2002). Planes that miss the centre of mass are never found, as in the publication.

As in the authors' program ShapeSPH, twice the radius of the second moment is half the side of a grid of 64³ voxels, and
the raster of the shape, within the ball of that radius, is compared with the squared distance transform. Ours: sums
over the voxels at directions of a Fibonacci spiral, where the program correlates spherical harmonics on 64 × 64
directions; the voxels that hold a point, where it rasterises triangles; distances that are interpolated before they are
squared; and the refinement.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.ndimage import distance_transform_edt, map_coordinates
from scipy.optimize import minimize

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import framed
from experiments.metrics.ranking import Ranking, distinct
from symjax.geometry.directions import fibonacci

RADII = 2.0
"""Half the grid's side in radii of the second moment (ShapeSPH)."""

APART = 10.0
"""Least angle between two answers, in degrees."""

SIMPLEX = 2.0
"""Side of the first simplex of the refinement, in degrees: a little less than the spacing of 2 500 directions."""


class Raster(NamedTuple):
    """A shape on a grid, with its centre of mass in the middle.

    Attributes:
        voxels: centres of the occupied voxels in the ball that the grid contains, in voxels from the middle.
        distance: of every voxel from the nearest occupied one, in voxels.
    """

    voxels: Float[np.ndarray, "m 3"]
    distance: Float[np.ndarray, "r r r"]

    def asymmetry(self, normal: Float[np.ndarray, " 3"]) -> float:
        """Mean squared distance (voxels²) of the mirror images of the occupied voxels from the shape."""
        middle = (len(self.distance) - 1) / 2
        images = self.voxels - 2 * np.outer(self.voxels @ normal, normal) + middle
        # squares would be interpolated half-way between 0 and 1 to 1/2, not 1/4, which favours the grid's own mirrors
        return float((map_coordinates(self.distance, images.T, order=1, mode="nearest") ** 2).mean())


@dataclass(frozen=True, kw_only=True)
class Kazhdan(Baseline):
    """Planes through the mean, at least 10 degrees apart, by minus the mean squared distance in voxels².

    Attributes:
        resolution: voxels along a side of the grid.
        num_normals: directions on the half sphere.
        most: most answers.
        refine: move the best directions to the best normals near them; still through the mean.
    """

    name: ClassVar[str] = "kazhdan"

    resolution: int = 64
    num_normals: int = 2500
    most: int = 10
    refine: bool = True

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`; draws nothing."""
        frame = framed(points, rng, most=len(points))
        raster = rasterise(frame.points, self.resolution)
        normals, scores = best(raster, fibonacci(self.num_normals), self.most)
        if self.refine:
            normals, scores = best(raster, np.array([refined(raster, normal) for normal in normals]), self.most)
        return frame.ranking(normals, np.zeros(len(normals)), scores)


def rasterise(points: Float[np.ndarray, "n 3"], resolution: int) -> Raster:
    """The voxels that hold a point of a centred cloud; points outside the grid are left out."""
    half = resolution / 2
    radius = RADII * np.sqrt((points**2).sum(axis=1).mean())
    cells = np.floor(points * (half / radius) + half).astype(int)
    cells = cells[((cells >= 0) & (cells < resolution)).all(axis=1)]
    occupied = np.zeros((resolution,) * 3, bool)
    occupied[tuple(cells.T)] = True
    voxels = np.argwhere(occupied) - (half - 0.5)
    # mirror images of what is in the ball are on the grid
    inside = np.linalg.norm(voxels, axis=1) <= half - 0.5
    return Raster(voxels[inside], distance_transform_edt(~occupied))


def best(
    raster: Raster, normals: Float[np.ndarray, "k 3"], most: int
) -> tuple[Float[np.ndarray, "j 3"], Float[np.ndarray, " j"]]:
    """Those of some normals that are the best within 10 degrees of themselves, the best first, and their scores."""
    scores = -np.array([raster.asymmetry(normal) for normal in normals])
    near = np.abs(normals @ normals.T) > np.cos(np.radians(APART))
    peaks = np.flatnonzero(scores >= np.where(near, scores, -np.inf).max(axis=1))
    # of equals, one
    chord = 2 * np.sin(np.radians(APART) / 2)
    kept = peaks[distinct(normals[peaks], np.zeros(len(peaks)), scores[peaks], apart=chord, most=most)]
    return normals[kept], scores[kept]


def refined(raster: Raster, normal: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """The best normal near a given one, by Nelder and Mead's method on the tangent plane."""
    tangents = np.linalg.svd(normal[None])[2][1:]

    def moved(u: Float[np.ndarray, " 2"]) -> Float[np.ndarray, " 3"]:
        return (normal + u @ tangents) / np.sqrt(1 + u @ u)

    simplex = np.radians(SIMPLEX) * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    found = minimize(
        lambda u: raster.asymmetry(moved(u)),
        np.zeros(2),
        method="Nelder-Mead",
        options={"initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6},
    )
    return moved(found.x)
