"""The result of `symjax.detect`."""

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
    """Matched points, and how well each pair agrees with the plane.

    Attributes:
        x: first point of every pair, in the units of the input points.
        y: second point of every pair.
        rows: rows of the two points in the input array.
        weight: how well each pair agrees with the plane, 0 to 1. For `robust`, the agreement of the mirror image with
            the surface, in place and normal direction; for `sym-hks`, the L2E weight exp(-f_i / 2σ²).
    """

    x: Float[np.ndarray, "m 3"]
    y: Float[np.ndarray, "m 3"]
    rows: Int[np.ndarray, "m 2"]
    weight: Float[np.ndarray, " m"]


@dataclass(frozen=True, eq=False)
class Detection:
    """The result of `symjax.detect`: the best mirror plane of a point cloud, its evidence, and what was computed.

    Arrays are NumPy arrays, in float64 unless they hold rows. Lengths are in the units of the input points, unless
    stated otherwise.

    Attributes:
        plane: the best plane, `normal · x = offset`; the largest component of its normal is positive.
        found: whether the method considers `plane` a mirror plane of the cloud. symjax's own methods require that
            `score` exceeds `threshold`. `robust` also requires that the cloud does not refute the plane, see `notes`;
            `sym-hks` also requires that the solver converged.
        ambiguous: whether other planes are as good as `plane`: one of several, all planes through an axis, or planes
            that an incomplete cloud can neither confirm nor refute.
        symmetry: "none", "one plane", "several planes", "axis" (all planes through an axis) or "sphere" (all planes
            through a centre).
        axis: a point on the axis of a continuous symmetry and the direction of the axis; None without such a symmetry.
        planes: the mirror planes, best first. Empty if none was found; a sample of them for a continuous symmetry.
        score: how well the cloud agrees with the plane, 0 to 1. For `robust`, agreement / (agreement + non-match
            penalty), both weighted sums over the points; for `sym-hks`, the mean L2E weight of the pairs.
        threshold: value that the score of a mirror plane exceeds, derived from the scores of other planes on the same
            cloud; None for a method without a threshold.
        candidates: the distinct planes that were scored, best first; the first one is `plane`.
        uncertainty: covariance and standard errors of the normal and offset; None if the method does not estimate them.
        pairs: the matched points.
        exactness: for `robust`, the score when only those mirror images agree that are as close to the surface as the
            points themselves: 0.5 to 1 for an exact symmetry, near 0 for a rough one. None for `sym-hks`.
        inlier_weight: weight from which a pair counts as an inlier.
        inlier_fraction: fraction of the pairs that are inliers; None for a method without pairs.
        converged: whether the solver converged.
        message: how the solver ended, as a sentence.
        method: name of the method.
        sigma: scale σ of the residual as a fraction of `diagonal`; None for a method without a scale.
        diagonal: length of the diagonal of the cloud's bounding box along its principal axes.
        seed: the seed that was passed, or None if a generator was passed.
        num_points: number of input points.
        used: rows of the input points that were used, after outliers and duplicates were removed and the rest thinned.
        cleaned: whether outliers or a ground plane were removed.
        notes: what was noticed in the points or done to them, as sentences.
        timings: seconds that each stage took, in order.
        points: the input points; None for a detection loaded from a file without them.

    Example:
        >>> import numpy as np
        >>> import symjax
        >>> sample = symjax.datasets.generate("quadruped", num_points=600, rng=0)  # symmetric about x = 0
        >>> det = symjax.detect(sample.points)
        >>> det.found, det.symmetry
        (True, 'one plane')
        >>> det.score > det.threshold
        True
        >>> f"normal within {det.uncertainty.normal_degrees:.1f} degrees (standard error)"
        'normal within 0.1 degrees (standard error)'
        >>> det.complete().shape  # the points and their mirror images
        (1200, 3)
        >>> bool(np.median(np.abs(det.asymmetry())) < 0.01 * det.diagonal)
        True
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
        """Number of points that were used."""
        return len(self.used)

    def mirror(self, points: ArrayLike) -> Float[np.ndarray, "n 3"]:
        """Reflects points in the plane.

        Args:
            points: (n, 3) points, in the units of the input points.

        Returns:
            Their mirror images.
        """
        return np.asarray(self.plane.reflect(np.asarray(points, dtype=float)))

    def on_surface(self, points: ArrayLike | None = None) -> Bool[np.ndarray, " n"]:
        """Finds which points belong to the object.

        If outliers or a ground plane were removed, these are the finite points near the points that were used;
        otherwise, all finite points.

        Args:
            points: (n, 3) points, in the units of the input points; by default the input points.

        Returns:
            True for each point that belongs to the object.

        Raises:
            InvalidArgumentError: if the detection was loaded without its points, and they are needed.
        """
        points = self._given(points)
        return completion.on_surface(points, self._given(None)[self.used] if self.cleaned else None)

    def complete(self, points: ArrayLike | None = None) -> Float[np.ndarray, "m 3"]:
        """Completes the object by its mirror image: P ∪ Q of the paper, Sec. 5.6.

        Args:
            points: (n, 3) points of the object, in the units of the input points; by default the input points that
                are `on_surface`.

        Returns:
            The points, followed by their mirror images.

        Raises:
            InvalidArgumentError: if `points` is None and the detection was loaded without its points.
        """
        if points is None:
            points = self._given(None)[self.on_surface()]
        return completion.complete(np.asarray(points, dtype=float), self.plane)

    def asymmetry(self, points: ArrayLike | None = None) -> Float[np.ndarray, " n"]:
        """Computes the asymmetry map: signed distance of every point's mirror image from the surface.

        The surface is that of the used points.

        Args:
            points: (n, 3) points, in the units of the input points; by default the input points.

        Returns:
            One distance a point, in the units of the input points: positive where the mirror image lies outside the
            surface, on the side that faces away from the centre of the cloud; NaN for a point that is not finite.

        Raises:
            InvalidArgumentError: if the detection was loaded without its points.
        """
        from symjax.detection.asymmetry import asymmetry

        return asymmetry(self._given(points), self.plane, self._given(None)[self.used])

    def _given(self, points: ArrayLike | None) -> Float[np.ndarray, "n 3"]:
        points = self.points if points is None else points
        if points is None:
            raise InvalidArgumentError(
                "this detection was loaded without its points: pass them to symjax.load(path, points=…)"
            )
        return np.asarray(points, dtype=float)

    def plot(self, path: str | os.PathLike[str] | None = None) -> "Figure":
        """Draws the cloud, the plane and the pairs as an interactive figure.

        Args:
            path: HTML file to write the figure to, as one self-contained page; None writes no file.

        Returns:
            The plotly figure.

        Raises:
            TooFewPointsError: if the detection was loaded without its points.
            InvalidArgumentError: if the file cannot be written.
        """
        from symjax.viz import html

        if path is not None:
            html.write_html(self, path)
        return html.figure(self)

    def picture(self, path: str | os.PathLike[str]) -> None:
        """Writes a PNG image: the cloud with the plane and the pairs, and beside it the completed object.

        Args:
            path: the file to write.

        Raises:
            TooFewPointsError: if the detection was loaded without its points.
            InvalidArgumentError: if the file cannot be written.
        """
        from symjax.viz.png import write_png

        write_png(self, path)

    def to_dict(self) -> dict[str, Any]:
        """Returns everything except the points as numbers, strings, lists and dictionaries, ready for JSON."""
        return serialisation.to_dict(self)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes `to_dict()` as JSON. `symjax.load` reads the file.

        Args:
            path: the file to write; an existing file is replaced.

        Raises:
            InvalidArgumentError: if the file cannot be written.
        """
        serialisation.save(self, path)
