"""What a method finds, in the frame and the units of the cloud: the answer before it is put in those of the points."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty

Symmetry = Literal["none", "one plane", "several planes", "axis", "sphere"]
Axis = tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]


CHANCE, EXACT_SHARE = 0.4, 0.4
"""Exactness that rough symmetries reach by chance, by a few exact parts: below it says nothing. Weight, beside the
score, of what is above."""


class Candidate(NamedTuple):
    """One distinct plane.

    Attributes:
        plane: the plane.
        score: how well the cloud agrees with it, 0 to 1; what that is, the method says.
        exactness: how exactly, 0 to 1; None where the method does not tell it, as `robust` does not of planes far
            behind the best, whose score is that of a thousand points.
    """

    plane: Plane
    score: float
    exactness: float | None = None

    @property
    def merit(self) -> float:
        """What candidates are ranked by: agreement, and a share of exact agreement, which noise cannot blur."""
        return self.score + EXACT_SHARE * max((self.exactness or 0.0) - CHANCE, 0.0)


class Finding(NamedTuple):
    """What a method finds in a cloud.

    Attributes:
        candidates: distinct planes, the best first.
        threshold: the score that a mirror plane exceeds.
        symmetry: what the planes that exceed it make up.
        ambiguous: whether others are as good as the first.
        axis: point and direction of the axis of a continuous symmetry.
        planes: the mirror planes among the candidates, the best first; of a continuous symmetry, some of them.
        rows: rows of the two points of every pair in the cloud.
        weight: how well each pair agrees with the first plane, 0 to 1.
        inlier_fraction: share of the pairs that agree with it.
        sigma: scale of the residual, in diagonals.
        converged: whether the solver converged.
        message: how it ended, a sentence.
        uncertainty: of the first plane, if the method tells it.
        notes: what was found, as sentences.
    """

    candidates: tuple[Candidate, ...]
    threshold: float
    symmetry: Symmetry
    ambiguous: bool
    axis: Axis | None
    planes: tuple[Plane, ...]
    rows: Int[np.ndarray, "m 2"]
    weight: Float[np.ndarray, "m"]
    inlier_fraction: float
    sigma: float
    converged: bool
    message: str
    uncertainty: Uncertainty | None
    notes: tuple[str, ...]
