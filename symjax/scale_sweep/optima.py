"""The distinct optima that the starts of a sweep reach."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import near
from symjax.geometry.similarity import Similarity

SAME_ANGLE, SAME_OFFSET = 0.05, 1e-3
"""Planes nearer than this (degrees; diagonals, at the middle) are one optimum. Of 256 starts on 119 pairs, those that
converged to one were within 1e-8 of each other, and distinct optima never within 0.3 degrees, from σ = 0.005 to 0.2 of
the diagonal."""

NOWHERE = -1
"""Rank of a start that has not converged."""


class Optimum(NamedTuple):
    """An optimum of one σ.

    Attributes:
        plane: its plane.
        loss: the loss there.
        share: share of the starts that reach it.
    """

    plane: Plane
    loss: float
    share: float


def optima(planes: Plane, loss: Float[np.ndarray, " r"], rank: Int[np.ndarray, " r"]) -> list[Optimum]:
    """The distinct optima, the best first.

    Args:
        planes: where the starts ended.
        loss: the loss there.
        rank: the ranks of what they reached.
    """
    found = []
    for number in range(rank.max() + 1):
        members = np.flatnonzero(rank == number)
        best = members[np.argmin(loss[members])]
        plane = Plane(planes.normal[best], planes.offset[best])
        found.append(Optimum(plane, float(loss[best]), len(members) / len(rank)))
    return found


def ranks(
    planes: Plane,
    loss: Float[np.ndarray, " r"],
    converged: Bool[np.ndarray, " r"],
    *,
    centre: Float[np.ndarray, " 3"],
    diagonal: float,
) -> Int[np.ndarray, " r"]:
    """The rank of the optimum that each start has reached, by loss: 0 is the best.

    Args:
        planes: where the starts ended.
        loss: the loss there.
        converged: which of them converged; the others get the rank `NOWHERE`.
        centre: middle of the cloud: the place where offsets are compared.
        diagonal: what they are compared with.
    """
    centred = Similarity(1.0, None, -centre).plane(planes)
    rank = np.full(len(loss), NOWHERE)
    left = converged & np.isfinite(loss)
    number = 0
    while left.any():
        best = int(np.argmin(np.where(left, loss, np.inf)))
        optimum = Plane(centred.normal[best], centred.offset[best])
        same = left & near(centred, optimum, angle=SAME_ANGLE, offset=SAME_OFFSET * diagonal)
        rank[same] = number
        left &= ~same
        number += 1
    return rank
