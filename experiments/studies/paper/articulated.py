"""A posed model, of which only parts are symmetric, as in the last example of the paper's Figure of partial models.

Heat kernel signatures stay the same when a limb bends, so that correspondences reach over to the bent limb; they do not
agree with any plane, and the estimator leaves them out. The picture shows which pairs agree. `bend` is how far the leg
is swung, `angle` how far the plane is from the true one, both in degrees; inliers at the trunk and at the legs are the
mean weights of the pairs above and below the hip.
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
    """What is run.

    Attributes:
        num_points: points of the cloud.
        bends: angles, in degrees, by which the left leg is swung forward.
        drawn: the angle that is drawn.
        seed: of the figure.
    """

    num_points: int = 8000
    bends: tuple[float, ...] = (0.0, 30.0, 60.0, 90.0)
    drawn: float = 60.0
    seed: int = 1


SIZES = {"full": Config(), "small": Config(bends=(60.0,))}


def posed(config: Config, bend: float) -> Float[np.ndarray, "n 3"]:
    """A standing figure whose left leg is swung forward about the hip, smoothly, by an angle in degrees."""
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
    """One row an angle."""
    rows = []
    for bend in config.bends:
        points = posed(config, bend)
        found = symjax.detect(points, method="sym-hks", rng=0)
        rows.append(
            {
                "bend": bend,
                "angle": float(found.plane.angle(TRUTH)),
                "found": found.found,
                "inliers": found.inlier_fraction,
                "inliers at the trunk": _share(found, points, above=True),
                "inliers at the legs": _share(found, points, above=False),
            }
        )
    return rows


def _share(found: Detection, points: Float[np.ndarray, "n 3"], *, above: bool) -> float:
    """Mean L2E weight of the pairs above, or below, the hip."""
    low, high = points[:, 2].min(), points[:, 2].max()
    middle = (found.pairs.x[:, 2] + found.pairs.y[:, 2]) / 2
    chosen = (middle > low + 0.47 * (high - low)) == above
    return float(found.pairs.weight[chosen].mean()) if chosen.any() else float("nan")


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """Symjax's own picture of the figure with the leg swung furthest."""
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
