"""The distinct optima that the starts of a sweep reach."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import near
from symjax.geometry.similarity import Similarity

SAME_ANGLE, SAME_OFFSET = 0.05, 1e-3
"""Planes nearer to each other than this (in degrees, and in diagonals at the centre of the cloud) are one optimum. For
256 starts on 119 pairs and σ from 0.005 to 0.2 of the diagonal, starts that converged to one optimum were within 1e-8
of each other, and distinct optima were never within 0.3 degrees."""

NOT_CONVERGED = -1
"""Rank of a start that did not converge."""


class Optimum(NamedTuple):
    """A local optimum of the loss at one σ.

    Attributes:
        plane: the plane.
        loss: its loss.
        fraction: fraction of the starts that reach the optimum.
    """

    plane: Plane
    loss: float
    fraction: float


def optima(planes: Plane, loss: Float[np.ndarray, " r"], rank: Int[np.ndarray, " r"]) -> list[Optimum]:
    """Returns the distinct optima, best first.

    Args:
        planes: the plane that each start ended at.
        loss: loss of each plane.
        rank: rank of the optimum that each start reached, see `ranks`.
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
    """Groups the planes into distinct optima, and returns the rank by loss of each start's optimum: 0 is the best.

    Args:
        planes: the plane that each start ended at.
        loss: loss of each plane.
        converged: whether each start converged; if not, its rank is `NOT_CONVERGED`.
        centre: centre of the cloud, where offsets are compared.
        diagonal: diagonal of the cloud, in which differences of offsets are measured.
    """
    centred = Similarity(1.0, None, -centre).plane(planes)
    rank = np.full(len(loss), NOT_CONVERGED)
    remaining = converged & np.isfinite(loss)
    number = 0
    while remaining.any():
        best = int(np.argmin(np.where(remaining, loss, np.inf)))
        optimum = Plane(centred.normal[best], centred.offset[best])
        same = remaining & near(centred, optimum, angle=SAME_ANGLE, offset=SAME_OFFSET * diagonal)
        rank[same] = number
        remaining &= ~same
        number += 1
    return rank
