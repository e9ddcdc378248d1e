"""Hit rate: the share of shapes whose plane is within an angle of a true one, and the area under its curve.

A hit is within the limits of both angle and offset: by the angle alone, every parallel plane would be a hit.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from experiments.metrics.deviation import WITHIN_OFFSET, Deviation
from symjax.errors import InvalidArgumentError

ANGLES = (1.0, 2.0, 5.0, 10.0, 45.0)
"""Angles at which hit rates are reported, in degrees."""

LARGEST = 45.0
"""Upper limit of the integral of the hit rate, in degrees."""


def hit_rates(deviations: Sequence[Deviation], *, within: float = WITHIN_OFFSET) -> dict[float, float]:
    """Computes the hit rate at each of `ANGLES`: the share with a smaller angle, and an offset error below `within`.

    Args:
        deviations: one per shape that has a true plane; (90, 1) or NaN if the method gave no plane.
        within: limit on the offset error, in diagonals.

    Raises:
        InvalidArgumentError: if there are no deviations.
    """
    angles = _angles(deviations, within)
    return {degrees: float((angles < degrees).mean()) for degrees in ANGLES}


def area(deviations: Sequence[Deviation], *, within: float = WITHIN_OFFSET, largest: float = LARGEST) -> float:
    """Computes the area under the hit rate as a function of the angle, from 0 to `largest` degrees, scaled to 0 to 1.

    The hit rate is a step function with one step per shape, at the shape's angle. The integral is therefore exactly the
    mean of max(1 − angle / largest, 0), and needs no grid.

    Args:
        deviations: as for `hit_rates`.
        within: limit on the offset error, in diagonals.
        largest: upper limit of the integral, in degrees.

    Raises:
        InvalidArgumentError: if there are no deviations.
    """
    return float(np.maximum(1 - _angles(deviations, within) / largest, 0).mean())


def _angles(deviations: Sequence[Deviation], within: float) -> Float[np.ndarray, " n"]:
    """Angles in degrees; infinite if the offset error is too large or the method gave no plane."""
    if not deviations:
        raise InvalidArgumentError("the list of deviations is empty: a hit rate needs at least one")
    angle, offset = np.array(deviations, float).T
    return np.where((offset < within) & ~np.isnan(angle), angle, np.inf)
