"""Flatness: recognises clouds that sample one flat sheet, noise across the sheet included.

Heights above a flat sheet are noise: they are unrelated to the heights beside them. The heights of a relief or a
curved shell vary smoothly along the sheet, and those of a plate lie on two faces.
"""

import numpy as np
from jaxtyping import Float, Int, Real
from scipy.spatial import cKDTree

RANK = 1e-6
"""Ratio of the smallest to the largest singular value below which a cloud is flat up to rounding."""

THICKEST = 0.15
"""Ratio of the smallest to the middle singular value above which a cloud is not flat, whatever its heights."""

NUM_NEIGHBOURS = 8
"""Neighbours along the sheet whose heights are compared with that of a point."""

NUM_POINTS = 2000
"""Number of points whose heights are tested."""

CORRELATION, DEVIATIONS = 0.15, 5.0
"""Largest rank correlation of heights, or of their absolute values, with the mean of the neighbours. It may also be
DEVIATIONS/√n, since 1/√n is about its standard deviation for noise. Measured: at most 0.14 on 300 points with noise;
0.25 and more on reliefs and shells as high as the noise, 0.8 and more without noise."""

BIMODALITY = 0.64
"""Largest coefficient of bimodality (skewness² + 1)/kurtosis of the heights: 1 for two faces, 0.56 for uniform noise,
0.33 for normal noise."""

TAIL, MAX_TAIL = 5.0, 0.02
"""Heights of more than TAIL robust standard deviations are parts of an object if they are more than this share."""


def is_flat(points: Float[np.ndarray, "n 3"]) -> bool:
    """Returns whether a cloud samples one flat sheet: a filled outline, or a curve in a plane.

    Args:
        points: distinct points about their mean, with the principal axes along the coordinates, the thinnest last.
    """
    across = points[:, 2]
    size = np.sqrt((points**2).mean(axis=0))
    if size[2] < RANK * size[0]:
        return True
    if size[2] > THICKEST * size[1]:
        return False
    step = max(1, len(points) // NUM_POINTS)
    height = across - np.median(across)
    deviation = 1.4826 * float(np.median(np.abs(height)))
    inside = np.abs(height) <= TAIL * deviation
    if np.mean(~inside) > MAX_TAIL or _bimodality(height[inside]) > BIMODALITY:
        return False
    count = min(NUM_NEIGHBOURS, len(points) - 1)
    neighbours = cKDTree(points[:, :2]).query(points[::step, :2], k=count + 1)[1][:, 1:]
    limit = max(CORRELATION, DEVIATIONS / np.sqrt(len(neighbours)))
    ranks, spread = _ranks(height), _ranks(np.abs(height - np.median(height[inside])))
    return all(_correlation(r[::step], r[neighbours].mean(axis=1)) <= limit for r in (ranks, spread))


def _ranks(values: Float[np.ndarray, " n"]) -> Int[np.ndarray, " n"]:
    """Returns ranks from 0 on, the same for equal values, without `scipy.stats`, which takes a second to import."""
    return np.searchsorted(np.sort(values), values)


def _bimodality(height: Float[np.ndarray, " n"]) -> float:
    """Returns Sarle's coefficient of bimodality."""
    unit = height - height.mean()
    deviation = float(np.sqrt((unit**2).mean()))
    if deviation == 0:
        return 1.0
    unit /= deviation
    return float(((unit**3).mean() ** 2 + 1) / (unit**4).mean())


def _correlation(a: Real[np.ndarray, " n"], b: Real[np.ndarray, " n"]) -> float:
    if not (np.ptp(a) and np.ptp(b)):
        return 0.0
    return float(np.corrcoef(a, b)[0, 1])
