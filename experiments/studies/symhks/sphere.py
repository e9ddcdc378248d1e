"""The Laplacian of the unit sphere from 1 000 to 100 000 points, and how the spectrum stands up to being moved.

The area should be 4π and the first positive eigenvalue 2, three times, at every density and at every place.
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
    """What is run.

    Attributes:
        sizes: points on the sphere.
        moved: points on the ellipsoid whose spectrum is compared before and after.
        seed: seed of the points.
    """

    sizes: tuple[int, ...] = (1_000, 3_000, 10_000, 30_000, 100_000)
    moved: int = 5_000
    seed: int = 0


SIZES = {"full": Config(), "small": Config(sizes=(1_000, 3_000), moved=1_000)}


def run(config: Config) -> list[Row]:
    """One row a size, then one a change."""
    rng = np.random.default_rng(config.seed)
    rows = []
    for size in tqdm(config.sizes, disable=None):
        found = spectrum(_sphere(rng, size), num_eigs=6)
        rows.append(_row("area / 4 pi", size, found.area / (4 * np.pi), "1 +- 0.02"))
        rows.append(_row("first eigenvalue / 2", size, found.eigenvalues[1] / 2, "1 +- 0.08"))
    # no two eigenvalues of an ellipsoid are alike
    points = _sphere(rng, config.moved) * [1.0, 1.5, 2.0]
    before = spectrum(points).eigenvalues[1:]
    for change, moved in _moved(points, rng).items():
        largest = float(np.abs(spectrum(moved).eigenvalues[1:] / before - 1).max())
        rows.append(_row(f"change by {change}", config.moved, largest, "<= 0.001"))
    return rows


def _row(what: str, size: int, value: float, target: str) -> Row:
    return {"what": what, "points": size, "value": float(value), "target": target}


def _sphere(rng: np.random.Generator, size: int) -> Float[np.ndarray, "n 3"]:
    points = rng.normal(size=(size, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def _moved(points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> dict[str, Float[np.ndarray, "n 3"]]:
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    return {
        "rotation": points @ turn.T,
        "reflection": points @ turn.T * [-1.0, 1.0, 1.0],
        "permutation": points[rng.permutation(len(points))],
        f"shift by {SHIFT:g}": points + SHIFT,
    }


STUDY = Study("sphere", __doc__, SIZES, run, data="points drawn on the unit sphere and on an ellipsoid")
