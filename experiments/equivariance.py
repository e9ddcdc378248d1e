"""The whole road under O(3), shift, scale and permutation: how far the plane is from having moved with the cloud."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from tqdm import tqdm

import symjax
from experiments import report
from experiments.clouds import generated
from experiments.report import Row
from symjax.plane import Plane

CHANGES = ("rotation", "reflection", "permutation", "shift by 1e6", "scale 1e-12", "scale 1e12", "all at once")
TARGET = "<= 0.1 deg, 0.001 diag"


@dataclass(frozen=True)
class Config:
    """What is run.

    Attributes:
        num_points: points of a cloud.
        kinds: generated kinds, counted from the first; one object of each.
        seed: of the changes.
    """

    num_points: int = 5000
    kinds: int = 12
    seed: int = 0


SIZES = {"full": Config(), "small": Config(num_points=1500, kinds=2)}


def run(config: Config) -> list[Row]:
    """One row a cloud and change."""
    rows = []
    for number, case in zip(tqdm(range(config.kinds), disable=None), generated(config.num_points, 1), strict=False):
        before = symjax.detect(case.points, rng=0)
        for change in CHANGES:
            rng = np.random.default_rng([config.seed, number])
            turn, shift, scale, order = _change(change, len(case.points), rng)
            after = symjax.detect((scale * case.points @ turn.T + shift)[order], rng=0)
            normal = turn @ before.plane.normal
            # a point of the plane near the cloud: far from the origin the offset itself is ill-conditioned
            foot = scale * turn @ (case.points.mean(axis=0) - _height(before.plane, case.points) * before.plane.normal)
            away = float(np.abs(after.plane.signed_distance((foot + shift)[None])[0])) / after.diagonal
            angle = float(after.plane.angle(Plane(normal, np.zeros(()))))
            rows.append({"model": case.name, "change": change, "angle": angle, "offset": away})
    return rows


def _height(plane: Plane, points: np.ndarray) -> float:
    return float(plane.signed_distance(points.mean(axis=0)[None])[0])


def _change(change: str, num_points: int, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
    every = change == "all at once"
    turn, shift, scale, order = np.eye(3), np.zeros(3), 1.0, np.arange(num_points)
    if change in ("rotation", "reflection") or every:
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn)) * (1.0 if change == "rotation" else -1.0)
    if change.startswith("shift") or every:
        shift = rng.normal(size=3) * 1e6
    if change.startswith("scale"):
        scale = float(change.split()[1])
    if change == "permutation" or every:
        order = rng.permutation(num_points)
    return turn, shift, scale, order


def summary(rows: list[Row]) -> list[Row]:
    """The largest of every change."""
    return [
        {
            "change": change,
            "clouds": sum(row["change"] == change for row in rows),
            "largest deg": max(row["angle"] for row in rows if row["change"] == change),
            "largest offset": max(row["offset"] for row in rows if row["change"] == change),
            "target": TARGET,
        }
        for change in CHANGES
    ]


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    report.main(__file__, __doc__, SIZES, run, summary, argv=argv)


if __name__ == "__main__":
    main()
