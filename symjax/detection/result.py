"""The answer of `symjax.detect`: planes, evidence, and what can be done with them."""

import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import ArrayLike

from symjax.detection import completion, serialisation
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.method.result import Axis, Candidate, Symmetry

if TYPE_CHECKING:
    from plotly.graph_objects import Figure


class Pairs(NamedTuple):
    """Matched points and how well each pair agrees with the plane.

    Attributes:
        x: one end of every pair, in the units of the given points.
        y: the other end.
        rows: rows of the two ends in the given points.
        weight: how well each pair agrees with the plane, 0 to 1: by `robust` the agreement of mirror image and surface
            in place and normal, by `sym-hks` the L2E weight exp(-f_i / 2σ²).
    """

    x: Float[np.ndarray, "m 3"]
    y: Float[np.ndarray, "m 3"]
    rows: Int[np.ndarray, "m 2"]
    weight: Float[np.ndarray, " m"]


@dataclass(frozen=True, eq=False)
class Detection:
    """A detected mirror plane. NumPy arrays in float64, in the units of the given points.

    Attributes:
        plane: the plane `normal · x = offset`, of canonical sign.
        found: whether the method takes the plane for a mirror plane: whether `score` exceeds `threshold`.
        ambiguous: whether other candidates are as good: several mirror planes, or all planes through an axis.
        symmetry: "none", "one plane", "several planes", "axis" or "sphere".
        axis: point and direction of the axis of a continuous symmetry, or None.
        planes: the mirror planes, the best first: none, one, or several; of a continuous symmetry, some of them.
        score: how well the cloud agrees with the plane, 0 to 1. By `robust`, the agreement of the mirrored points
            over agreement and non-match penalty, weighted; by `sym-hks`, mean L2E weight of the pairs.
        threshold: what the score must exceed, from what other planes reach on the same cloud; None for a method that
            has no threshold. `sym-hks` also needs the solver to converge: `found` is false where `converged` is.
        candidates: distinct planes, best first; the first is `plane`.
        uncertainty: standard errors of normal and offset with their covariance, or None where the method has none.
        pairs: the matched points.
        exactness: by `robust`, the score where only mirror images that lie as close to the surface as its own points do
            agree: 0.5 to 1 for an exact symmetry, near 0 for a rough one. None by `sym-hks`.
        inlier_weight: weight from which a pair counts as an inlier.
        inlier_fraction: share of the pairs that are inliers; None for a method without pairs.
        converged: whether the solver converged.
        message: how it ended, a sentence.
        method: name of the method.
        sigma: scale σ of the residual as a fraction of `diagonal`; None for a method without one.
        diagonal: length of the diagonal of the cloud's box in its principal frame.
        seed: the seed given, or None for a generator.
        num_points: points given.
        used: rows of the given points that were used, after dropping, merging and thinning.
        cleaned: whether scattered outliers, or a ground plane, were left out.
        notes: what was done to the points, or found in them, as sentences.
        timings: seconds of every stage, in order.
        points: the given points; None in a detection loaded from a file.
    """

    plane: Plane
    found: bool
    ambiguous: bool
    symmetry: Symmetry
    axis: Axis | None
    planes: tuple[Plane, ...]
    score: float
    threshold: float | None
    candidates: tuple[Candidate, ...]
    uncertainty: Uncertainty | None
    pairs: Pairs
    exactness: float | None
    inlier_weight: float
    inlier_fraction: float | None
    converged: bool
    message: str
    method: str
    sigma: float | None
    diagonal: float
    seed: int | None
    num_points: int
    used: Int[np.ndarray, " k"]
    cleaned: bool
    notes: tuple[str, ...]
    timings: dict[str, float]
    points: Float[np.ndarray, "n 3"] | None = field(default=None, repr=False)

    @property
    def num_used(self) -> int:
        """Number of points used."""
        return len(self.used)

    def mirror(self, points: ArrayLike) -> Float[np.ndarray, "n 3"]:
        """Mirror images of points in the plane."""
        return np.asarray(self.plane.reflect(np.asarray(points, dtype=float)))

    def on_surface(self, points: ArrayLike | None = None) -> Bool[np.ndarray, " n"]:
        """Which points belong to the object: the finite ones, near those used if outliers or a ground were left out.

        Args:
            points: points in the given units; by default those kept.

        Raises:
            InvalidArgumentError: neither passed nor kept.
        """
        points = self._given(points)
        return completion.on_surface(points, self._given(None)[self.used] if self.cleaned else None)

    def complete(self, points: ArrayLike | None = None) -> Float[np.ndarray, "m 3"]:
        """The completed object P ∪ Q (Sec. 5.6): the points and their mirror images.

        Args:
            points: by default those kept that are `on_surface`.

        Raises:
            InvalidArgumentError: neither passed nor kept.
        """
        if points is None:
            points = self._given(None)[self.on_surface()]
        return completion.complete(np.asarray(points, dtype=float), self.plane)

    def asymmetry(self, points: ArrayLike | None = None) -> Float[np.ndarray, " n"]:
        """The asymmetry map: signed distance of every point's mirror image from the surface, in the points' units.

        Positive where the image lies outside, on the side that faces away from the middle of the cloud. The surface is
        that of the used points.

        Args:
            points: points in the given units; by default those kept.

        Returns:
            Distances in the order of the points; NaN for one that is not finite.

        Raises:
            InvalidArgumentError: neither passed nor kept.
        """
        from symjax.detection.asymmetry import asymmetry

        return asymmetry(self._given(points), self.plane, self._given(None)[self.used])

    def _given(self, points: ArrayLike | None) -> Float[np.ndarray, "n 3"]:
        points = self.points if points is None else points
        if points is None:
            raise InvalidArgumentError("this detection was loaded without its points: pass them")
        return np.asarray(points, dtype=float)

    def plot(self, path: str | os.PathLike[str] | None = None) -> "Figure":
        """Interactive picture; with a path, also written there as one self-contained HTML page."""
        from symjax.viz import html

        if path is not None:
            html.write_html(self, path)
        return html.figure(self)

    def picture(self, path: str | os.PathLike[str]) -> None:
        """Writes a PNG of cloud, plane and pairs beside the completed object."""
        from symjax.viz.png import write_png

        write_png(self, path)

    def to_dict(self) -> dict[str, Any]:
        """Everything but the points, as numbers, strings, lists and dictionaries that JSON holds."""
        return serialisation.to_dict(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes `to_dict()` as JSON; `symjax.load` reads it back, without the points."""
        serialisation.save(self, path)
