"""The Laplacian of the unit sphere from 1 000 to 100 000 points, and the invariance of the spectrum.

The area should be 4π and the first positive eigenvalue 2, with multiplicity three, at every density. The spectrum of an
ellipsoid should not change under rotation, reflection, permutation and shift.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from tqdm import tqdm

from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax.symhks.spectrum import spectrum

SHIFT = 1e6


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        sizes: numbers of points on the sphere.
        moved: number of points on the ellipsoid, whose spectrum is compared before and after transformations.
        seed: seed of the points.
    """

    sizes: tuple[int, ...] = (1_000, 3_000, 10_000, 30_000, 100_000)
    moved: int = 5_000
    seed: int = 0


SIZES = {"full": Config(), "small": Config(sizes=(1_000, 3_000), moved=1_000)}


def run(config: Config) -> list[Row]:
    """Returns two rows per size of the sphere, then one row per transformation of the ellipsoid."""
    rng = np.random.default_rng(config.seed)
    rows = []
    for size in tqdm(config.sizes, disable=None):
        laplacian = spectrum(_sphere(rng, size), num_eigs=6)
        rows.append(_row("area / 4 pi", size, laplacian.area / (4 * np.pi), "1 +- 0.02"))
        rows.append(_row("first eigenvalue / 2", size, laplacian.eigenvalues[1] / 2, "1 +- 0.08"))
    # the eigenvalues of an ellipsoid are distinct
    points = _sphere(rng, config.moved) * [1.0, 1.5, 2.0]
    before = spectrum(points).eigenvalues[1:]
    for change, moved in _moved(points, rng).items():
        largest = float(np.abs(spectrum(moved).eigenvalues[1:] / before - 1).max())
        rows.append(_row(f"change by {change}", config.moved, largest, "<= 0.001"))
    return rows


def _row(quantity: str, size: int, value: float, target: str) -> Row:
    return {"quantity": quantity, "points": size, "value": float(value), "target": target}


def _sphere(rng: np.random.Generator, size: int) -> Float[np.ndarray, "n 3"]:
    points: Float[np.ndarray, "n 3"] = rng.normal(size=(size, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    return points


def _moved(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> dict[str, Float[np.ndarray, "n 3"]]:
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.sign(np.linalg.det(rotation))
    return {
        "rotation": points @ rotation.T,
        "reflection": points @ rotation.T * [-1.0, 1.0, 1.0],
        "permutation": points[rng.permutation(len(points))],
        f"shift by {SHIFT:g}": points + SHIFT,
    }


STUDY = Study("sphere", __doc__, SIZES, run, data="random points on the unit sphere and on an ellipsoid")
