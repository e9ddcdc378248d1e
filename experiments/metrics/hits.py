"""Share of answers within an angle, and the area under that curve.

A hit is within the angle and within the offset: an angle alone would call every parallel plane right.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from experiments.metrics.deviation import WITHIN_OFFSET, Deviation
from symjax.errors import InvalidArgumentError

ANGLES = (1.0, 2.0, 5.0, 10.0, 45.0)
"""Degrees at which hit rates are reported."""

LARGEST = 45.0
"""Degrees up to which the area is taken."""


def hit_rates(deviations: Sequence[Deviation], *, within: float = WITHIN_OFFSET) -> dict[float, float]:
    """Share of answers whose angle is below each of `ANGLES`, the offset being below `within`.

    Args:
        deviations: one for every shape that has a right plane; (90, 1) or NaN where there was no answer.
        within: largest offset error, in diagonals.

    Raises:
        InvalidArgumentError: there are no deviations.
    """
    angles = _angles(deviations, within)
    return {degrees: float((angles < degrees).mean()) for degrees in ANGLES}


def area(deviations: Sequence[Deviation], *, within: float = WITHIN_OFFSET, largest: float = LARGEST) -> float:
    """Area under the hit rate as a function of the angle, from 0 to `largest` degrees, over that range: 0 to 1.

    The rate is a step function, each answer a step at its own angle: the integral is the mean of 1 − angle / largest,
    exactly, and no grid is needed.

    Args:
        deviations: as for `hit_rates`.
        within: largest offset error, in diagonals.
        largest: degrees up to which the area is taken.

    Raises:
        InvalidArgumentError: there are no deviations.
    """
    return float(np.maximum(1 - _angles(deviations, within) / largest, 0).mean())


def _angles(deviations: Sequence[Deviation], within: float) -> Float[np.ndarray, " n"]:
    """Degrees; infinite where the offset is too large, or there was no answer."""
    if not deviations:
        raise InvalidArgumentError("a hit rate of no answers at all: give at least one deviation")
    angle, offset = np.array(deviations, float).T
    return np.where((offset < within) & ~np.isnan(angle), angle, np.inf)
