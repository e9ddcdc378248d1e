"""What a method finds, in the frame and the units of the cloud: `detect` brings it into those of the given points."""

from dataclasses import dataclass, field
from typing import Literal, NamedTuple, get_args

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import MethodError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty

Symmetry = Literal["none", "one plane", "several planes", "axis", "sphere"]
Axis = tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]
"""A point and a direction."""


class Candidate(NamedTuple):
    """One distinct plane.

    Attributes:
        plane: the plane.
        score: how well the cloud agrees with it; the method says on which scale. 0 to 1 for symjax's own methods.
        ranking_score: what candidates are ranked by: the score, or the score with what the method adds to it.
        exactness: how exactly, 0 to 1; None where the method does not compute it, as `Robust` does not for planes far
            behind the best.
    """

    plane: Plane
    score: float
    ranking_score: float
    exactness: float | None = None


@dataclass(frozen=True, eq=False)
class MethodResult:
    """What a method finds in a cloud. Only what a method can say needs to be given.

    Attributes:
        candidates: distinct planes, the best first; at least one.
        planes: the mirror planes among the candidates, the best first; of a continuous symmetry, some of them.
        symmetry: what the mirror planes make up; "none" if there is none.
        threshold: the score that a mirror plane exceeds; None for a method that has none.
        ambiguous: whether other planes are as good as the first.
        axis: point and direction of the axis of a continuous symmetry.
        rows: rows of the two points of every pair in the cloud.
        weight: how well each pair agrees with the first plane, 0 to 1.
        inlier_weight: weight from which a pair counts as an inlier.
        inlier_fraction: share of the pairs that are inliers; None for a method without pairs.
        sigma: scale σ of the residual, in diagonals; None for a method without one.
        converged: whether the solver converged.
        message: how it ended, as a sentence.
        uncertainty: of the first plane, if the method estimates it.
        notes: what was found, as sentences.
    """

    candidates: tuple[Candidate, ...]
    planes: tuple[Plane, ...]
    symmetry: Symmetry
    threshold: float | None = None
    ambiguous: bool = False
    axis: Axis | None = None
    rows: Int[np.ndarray, "m 2"] = field(default_factory=lambda: np.empty((0, 2), dtype=int))
    weight: Float[np.ndarray, " m"] = field(default_factory=lambda: np.empty(0))
    inlier_weight: float = 0.5
    inlier_fraction: float | None = None
    sigma: float | None = None
    converged: bool = True
    message: str = ""
    uncertainty: Uncertainty | None = None
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Raises MethodError for a symmetry that is unknown, or that contradicts `ambiguous`."""
        if self.symmetry not in get_args(Symmetry):
            raise MethodError(f"symmetry {self.symmetry!r} is unknown: it is one of {', '.join(get_args(Symmetry))}")
        if self.ambiguous and self.symmetry in ("none", "one plane"):
            raise MethodError(f"symmetry {self.symmetry!r} is not ambiguous: other planes as good are several planes")
