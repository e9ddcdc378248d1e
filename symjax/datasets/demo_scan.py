"""The scan of `symjax demo`: made here, so that nothing is downloaded and the true plane is known."""

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
"""Share of the surface that the scan lacks, one connected part."""
NOISE = 0.002
"""Standard deviation of the noise in each coordinate, as a fraction of the diagonal."""
OUTLIERS = 0.5
"""Outliers in the scan's box per point of the scan."""

DESCRIPTION = (
    f"A {KIND} of {NUM_POINTS} points: {MISSING:.0%} of it missing, noise {NOISE:.1%} of its size, and an outlier for "
    f"every {1 / OUTLIERS:.0f} other points"
)


class DemoScan(NamedTuple):
    """A partial, noisy cloud and the mirror plane of the object that it was taken from.

    Attributes:
        points: the cloud.
        truth: the object's mirror plane.
        up: the object's upright direction, for pictures: a random pose has none.
    """

    points: Float[np.ndarray, "n 3"]
    truth: Plane
    up: Float[np.ndarray, " 3"]


def make_scan(seed: int) -> DemoScan:
    """A random object in a random pose, with a part missing, noise and outliers; the same for the same seed."""
    rng = np.random.default_rng(seed)
    upright = generate(KIND, num_points=NUM_POINTS, rng=rng)
    whole = pose(upright, rng)
    corrupted = corrupt(whole.points, rng, missing=MISSING, noise=NOISE, outliers=OUTLIERS)
    truth = Plane(whole.normals[0], whole.offsets[0])
    before, after = (points - points.mean(axis=0) for points in (upright.points, whole.points))
    up = np.linalg.lstsq(before, after)[0][2]
    return DemoScan(corrupted.points, truth, up)
