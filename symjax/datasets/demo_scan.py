"""The scan that `symjax demo` uses. It is generated, so nothing is downloaded and the true plane is known."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.datasets.corruption import corrupt
from symjax.datasets.kinds import generate
from symjax.datasets.sample import pose
from symjax.geometry.plane import Plane

KIND = "quadruped"
NUM_POINTS = 6000
MISSING = 0.25
"""Fraction of the points that is removed as one part."""
NOISE = 0.002
"""Standard deviation of the noise in each coordinate, as a fraction of the diagonal."""
OUTLIERS = 0.5
"""Number of outliers per point of the object, uniform in its bounding box."""

DESCRIPTION = (
    f"A {KIND} sampled at {NUM_POINTS} points, with {MISSING:.0%} of the points removed, noise of {NOISE:.1%} of the "
    f"diagonal, and one outlier for every {1 / OUTLIERS:.0f} remaining points"
)


class DemoScan(NamedTuple):
    """A partial, noisy cloud and the mirror plane of its object.

    Attributes:
        points: the cloud.
        truth: the object's mirror plane.
        up: the object's upright direction after the random pose, for the pictures.
    """

    points: Float[np.ndarray, "n 3"]
    truth: Plane
    up: Float[np.ndarray, " 3"]


def make_scan(seed: int) -> DemoScan:
    """Generates a random object in a random pose, removes a part of it, and adds noise and outliers."""
    rng = np.random.default_rng(seed)
    upright = generate(KIND, num_points=NUM_POINTS, rng=rng)
    whole = pose(upright, rng)
    corrupted = corrupt(whole.points, rng, missing=MISSING, noise=NOISE, outliers=OUTLIERS)
    truth = Plane(whole.normals[0], whole.offsets[0])
    before, after = (points - points.mean(axis=0) for points in (upright.points, whole.points))
    up = np.linalg.lstsq(before, after)[0][2]
    return DemoScan(corrupted.points, truth, up)
