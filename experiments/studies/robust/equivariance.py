"""Equivariance of both methods under O(3), shift, scale and permutation: whether the plane moves with the cloud.

The table has the largest difference between the plane of the transformed cloud and the transformed plane of the cloud,
over generated objects, in degrees and diagonals.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from tqdm import tqdm

import symjax
from experiments.data import GENERATED
from experiments.data.cases import generated_cases
from experiments.framework.options import split_names
from experiments.framework.study import Study
from experiments.framework.tables import Row, grouped
from symjax import datasets
from symjax.detection.methods import METHODS
from symjax.detection.result import Detection
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity

CHANGES = ("rotation", "reflection", "permutation", "shift by 1e6", "scale 1e-12", "scale 1e12", "all at once")
TARGET = "<= 0.1 deg, 0.001 diag"


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_points: points of a cloud.
        kinds: number of generated kinds, from the first; one object of each.
        seed: seed of the transformations.
        methods: names of the methods, separated by commas.
    """

    num_points: int = 5000
    kinds: int = 12
    seed: int = 0
    methods: str = ",".join(METHODS)


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=2)}


def run(config: Config) -> list[Row]:
    """Returns one row per cloud, method and change."""
    rows = []
    cases = generated_cases(config.num_points, 1, list(datasets.KINDS)[: config.kinds])
    for number, case in enumerate(tqdm(cases, total=config.kinds, disable=None)):
        for method in split_names(config.methods, METHODS):
            before = symjax.detect(case.points, method, rng=0)
            for name in CHANGES:
                move, order = _change(name, len(case.points), np.random.default_rng([config.seed, number]))
                after = symjax.detect(np.asarray(move.points(case.points))[order], method, rng=0)
                row = {"method": method, "model": case.name, "change": name}
                rows.append(row | _difference(before.plane, case.points, move, after))
    return rows


def _change(name: str, num_points: int, rng: np.random.Generator) -> tuple[Similarity, Int[np.ndarray, " n"]]:
    """The transformation of a cloud, and the new order of its points."""
    every = name == "all at once"
    rotation, shift, scale, order = np.eye(3), np.zeros(3), 1.0, np.arange(num_points)
    if name in ("rotation", "reflection") or every:
        rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        rotation *= np.sign(np.linalg.det(rotation)) * (1.0 if name == "rotation" else -1.0)
    if name.startswith("shift") or every:
        shift = rng.normal(size=3) * 1e6
    if name.startswith("scale"):
        scale = float(name.split()[1])
    if name == "permutation" or every:
        order = rng.permutation(num_points)
    return Similarity(scale, rotation, shift), order


def _difference(before: Plane, points: Float[np.ndarray, "n 3"], move: Similarity, after: Detection) -> Row:
    """Difference between the plane of the moved cloud and the moved plane of the cloud, in degrees and diagonals."""
    # compare the offsets at a point of the plane near the cloud: far from the origin they are ill-conditioned
    centre = points.mean(axis=0)
    foot = move.points(centre - float(before.signed_distance(centre[None])[0]) * before.normal)
    offset = float(np.abs(after.plane.signed_distance(foot[None])[0]))
    return {"angle": float(after.plane.angle(move.plane(before))), "offset": offset / after.diagonal}


def summary(rows: list[Row]) -> list[Row]:
    """Tabulates the largest differences by method and change."""
    return [
        {
            **{"method": method, "change": change, "clouds": len(group)},
            "largest deg": max(row["angle"] for row in group),
            "largest offset": max(row["offset"] for row in group),
            "target": TARGET,
        }
        for (method, change), group in grouped(rows, "method", "change").items()
    ]


STUDY = Study("equivariance", __doc__, SIZES, run, summary, data=GENERATED)
