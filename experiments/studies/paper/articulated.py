"""Detection on a figure with a bent leg, of which only parts are symmetric, as in the paper's last partial model.

Heat kernel signatures do not change when a limb bends, so Sym-HKS also finds pairs between the bent leg and the other.
These pairs agree with no plane, and the estimator rejects them as outliers. The picture shows which pairs agree with
the plane. `bend` is the angle by which the leg is swung and `angle` the angle between the detected and the true plane,
both in degrees. The inliers at the trunk and at the legs are the mean weights of the pairs above and below the hip.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float
from PIL import Image

import symjax
from experiments.framework.study import Study
from experiments.framework.tables import Row
from symjax import datasets
from symjax.detection.result import Detection
from symjax.geometry.plane import Plane

TRUTH = Plane(np.array([1.0, 0.0, 0.0]), np.zeros(()))


@dataclass(frozen=True)
class Config:
    """Options of the study.

    Attributes:
        num_points: points of the cloud.
        bends: angles, in degrees, by which the left leg is swung forward.
        drawn: the angle of the picture, in degrees.
        seed: seed of the figure.
    """

    num_points: int = 8000
    bends: tuple[float, ...] = (0.0, 30.0, 60.0, 90.0)
    drawn: float = 60.0
    seed: int = 1


SIZES = {"full": Config(), "small": Config(bends=(60.0,))}


def posed(config: Config, bend: float) -> Float[np.ndarray, "n 3"]:
    """Generates a standing figure and swings its left leg forward about the hip, smoothly, by an angle in degrees."""
    points = datasets.generate("human", num_points=config.num_points, rng=config.seed).points.copy()
    low, high = points[:, 2].min(), points[:, 2].max()
    hip = low + 0.47 * (high - low)
    # 0 above the hip and on the right, 1 on the left leg, and smooth between
    share = np.clip((hip - points[:, 2]) / (0.06 * (high - low)), 0, 1) * np.clip(points[:, 0] / 0.02, 0, 1)
    angle = np.radians(bend) * share
    y, z = points[:, 1].copy(), points[:, 2] - hip
    points[:, 1] = np.cos(angle) * y - np.sin(angle) * z
    points[:, 2] = hip + np.sin(angle) * y + np.cos(angle) * z
    return points


def run(config: Config) -> list[Row]:
    """Returns one row per angle of the leg."""
    rows = []
    for bend in config.bends:
        points = posed(config, bend)
        detection = symjax.detect(points, method="sym-hks", rng=0)
        rows.append(
            {
                "bend": bend,
                "angle": float(detection.plane.angle(TRUTH)),
                "found": detection.found,
                "inliers": detection.inlier_fraction,
                "inliers at the trunk": _mean_weight(detection, points, above=True),
                "inliers at the legs": _mean_weight(detection, points, above=False),
            }
        )
    return rows


def _mean_weight(detection: Detection, points: Float[np.ndarray, "n 3"], *, above: bool) -> float:
    """Mean L2E weight of the pairs above, or below, the hip."""
    low, high = points[:, 2].min(), points[:, 2].max()
    heights = (detection.pairs.x[:, 2] + detection.pairs.y[:, 2]) / 2
    chosen = (heights > low + 0.47 * (high - low)) == above
    return float(detection.pairs.weight[chosen].mean()) if chosen.any() else float("nan")


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Draws symjax's picture of the figure with its leg swung by `config.drawn` degrees."""
    symjax.detect(posed(config, config.drawn), method="sym-hks", rng=0).picture(path)
    Image.open(path).convert("RGB").save(path.with_suffix(".pdf"))


STUDY = Study(
    "articulated",
    __doc__,
    SIZES,
    run,
    draw=draw,
    data="a generated figure with one leg swung forward",
    paper="last example of its partial models",
)
