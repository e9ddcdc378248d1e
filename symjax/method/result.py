"""The result of a method, in the cloud frame; `detect` converts it to the units of the input points."""

from dataclasses import dataclass, field
from typing import Literal, NamedTuple, get_args

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import MethodError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty

Symmetry = Literal["none", "one plane", "several planes", "axis", "sphere"]
Axis = tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]
"""A point on the axis, and its direction."""


class Candidate(NamedTuple):
    """A scored plane. The best candidates of `Robust` are refined too; those far behind the best are not.

    Attributes:
        plane: the plane.
        score: how well the cloud agrees with the plane. The method defines the scale; `Robust` and `SymHKS` use 0 to 1.
        ranking_score: score by which candidates are ordered; a method may add further terms to `score`.
        exactness: score at the finest tolerance, 0 to 1. None if the method did not compute it; `Robust` skips it for
            planes far behind the best.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> plane = symjax.Plane(np.array([1.0, 0.0, 0.0]), np.array(0.0))
        >>> candidate = symjax.Candidate(plane, score=0.9, ranking_score=0.95)
        >>> print(candidate.exactness)
        None
    """

    plane: Plane
    score: float
    ranking_score: float
    exactness: float | None = None


@dataclass(frozen=True, eq=False)
class MethodResult:
    """Planes that a method finds in a cloud, and how it found them. All but the first three fields are optional.

    Lengths are in units of the diagonal, and coordinates are in the cloud frame.

    Attributes:
        candidates: distinct planes, the best first; at least one.
        planes: mirror planes among the candidates, the best first. Of a continuous symmetry, they are a selection.
        symmetry: kind of symmetry that the mirror planes form; "none" if there are no mirror planes.
        threshold: score that a mirror plane must exceed; None if the method has no threshold.
        ambiguous: whether other planes are as good as the first.
        axis: point and direction of the axis of a continuous symmetry.
        rows: rows in the cloud of the two points of each pair.
        weight: weight of each pair for the first plane, 0 to 1.
        inlier_weight: smallest weight of an inlier.
        inlier_fraction: fraction of the pairs that are inliers; None if the method has no pairs.
        sigma: scale σ of the residual; None if the method has no scale.
        converged: whether the solver converged.
        message: how the solver ended, as a sentence.
        uncertainty: uncertainty of the first plane, if the method estimates it.
        notes: remarks for the user, as sentences.

    Example:
        >>> plane = Plane(np.array([1.0, 0.0, 0.0]), np.array(0.0))
        >>> result = MethodResult((Candidate(plane, score=0.9, ranking_score=0.9),), (plane,), "one plane")
        >>> result.converged, len(result.rows)
        (True, 0)
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
        """Raises MethodError if the symmetry is unknown, or contradicts `ambiguous`."""
        if self.symmetry not in get_args(Symmetry):
            raise MethodError(f"symmetry {self.symmetry!r} is unknown: choose one of {', '.join(get_args(Symmetry))}")
        if self.ambiguous and self.symmetry == "none":
            raise MethodError("symmetry 'none' contradicts ambiguous=True: there is no plane to be as good as")
