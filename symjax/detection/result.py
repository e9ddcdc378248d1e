"""The answer of `symjax.detect`: plane, evidence, and what can be done with them."""

import json
import os
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from jaxtyping import ArrayLike, Bool, Float, Int
from scipy.spatial import cKDTree

from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.io.atomic import replacing
from symjax.method.result import Axis, Candidate, Symmetry

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

FORMAT = "symjax detection 2"

NEAR = 3.0
"""Distance from a used point, in usual distances between used points, within which a point belongs to the object."""


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
    weight: Float[np.ndarray, "m"]


@dataclass(frozen=True, eq=False)
class Detection:
    """A detected mirror plane. NumPy arrays in float64, in the units of the given points.

    Attributes:
        plane: the plane `normal · x = offset`, of canonical sign.
        found: whether `score` exceeds `threshold`.
        ambiguous: whether other candidates are as good: several mirror planes, or all planes through an axis.
        symmetry: "none", "one plane", "several planes", "axis" or "sphere".
        axis: point and direction of the axis of a continuous symmetry, or None.
        planes: the mirror planes, the best first: none, one, or several; of a continuous symmetry, some of them.
        score: how well the cloud agrees with the plane, 0 to 1. By `robust`, support over support and blame of the
            mirrored points; by `sym-hks`, mean L2E weight of the pairs.
        threshold: what the score must exceed, from what other planes reach on the same cloud.
        candidates: distinct planes, best first; the first is `plane`.
        uncertainty: standard errors of normal and offset with their covariance, or None where the method has none.
        pairs: the matched points.
        exactness: by `robust`, the score where only mirror images that lie as close to the surface as its own points do
            count as support: 0.5 to 1 for an exact symmetry, near 0 for a rough one. None by `sym-hks`.
        inlier_fraction: share of the pairs that agree with the plane.
        converged: whether the solver converged.
        message: how it ended, a sentence.
        method: name of the method.
        sigma: scale σ of the residual as a fraction of `diagonal`.
        diagonal: length of the diagonal of the cloud's box in its principal frame.
        seed: the seed given, or None for a generator.
        num_points: points given.
        used: rows of the given points that were used, after dropping, merging and thinning.
        cleaned: whether scattered outliers, or a floor, were left out.
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
    threshold: float
    candidates: tuple[Candidate, ...]
    uncertainty: Uncertainty | None
    pairs: Pairs
    exactness: float | None
    inlier_fraction: float
    converged: bool
    message: str
    method: str
    sigma: float
    diagonal: float
    seed: int | None
    num_points: int
    used: Int[np.ndarray, "k"]
    cleaned: bool
    notes: tuple[str, ...]
    timings: dict[str, float]
    points: Float[np.ndarray, "n 3"] | None = field(default=None, repr=False)

    @property
    def num_used(self) -> int:
        """Number of points used."""
        return len(self.used)

    def mirror(self, points: Float[ArrayLike, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Mirror images of points in the plane."""
        return np.asarray(self.plane.reflect(np.asarray(points, dtype=float)))

    def on_surface(self, points: Float[ArrayLike, "n 3"] | None = None) -> Bool[np.ndarray, "n"]:
        """Which points belong to the object: the finite ones; where outliers or a floor were left out, near used ones.

        Args:
            points: points in the given units; by default those kept.

        Raises:
            InvalidArgumentError: neither passed nor kept.
        """
        points = self._given(points)
        finite = np.asarray(np.isfinite(points).all(axis=1))
        if not self.cleaned:
            return finite
        surface = cKDTree(self._given(None)[self.used])
        usual = np.median(surface.query(surface.data, k=2)[0][:, 1])
        finite[finite] = surface.query(points[finite], workers=-1)[0] <= NEAR * usual
        return finite

    def complete(self, points: Float[ArrayLike, "n 3"] | None = None) -> Float[np.ndarray, "2n 3"]:
        """The completed object P ∪ Q (Sec. 5.6): the points and their mirror images.

        Args:
            points: by default those kept that are `on_surface`.

        Raises:
            InvalidArgumentError: neither passed nor kept.
        """
        if points is None:
            points = self._given(None)[self.on_surface()]
        points = np.asarray(points, dtype=float)
        return np.concatenate([points, self.mirror(points)])

    def asymmetry(self, points: Float[ArrayLike, "n 3"] | None = None) -> Float[np.ndarray, "n"]:
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

    def _given(self, points: Float[ArrayLike, "n 3"] | None) -> Float[np.ndarray, "n 3"]:
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
        values = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "points"}
        return {"format": FORMAT, **_plain(values)}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes `to_dict()` as JSON; `symjax.load` reads it back, without the points."""
        with replacing(path) as temporary:
            temporary.write_text(json.dumps(self.to_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def load(path: str | os.PathLike[str], *, points: Float[ArrayLike, "n 3"] | None = None) -> Detection:
    """Reads what `Detection.save` wrote.

    Args:
        path: the JSON file.
        points: the cloud, for `plot`, `picture` and `complete`; it is not in the file.

    Raises:
        FileFormatError: missing, unreadable, or no detection.
    """
    try:
        values = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise FileFormatError(f"cannot read {path}: {error.strerror}") from error
    except ValueError as error:
        raise FileFormatError(f"{path} is not JSON: {error}") from error
    if not isinstance(values, dict) or values.pop("format", None) != FORMAT:
        raise FileFormatError(f"{path} was not written by Detection.save (no {FORMAT!r})")
    try:
        pairs = values.pop("pairs")
        return Detection(
            plane=_plane(values.pop("plane")),
            axis=_arrays(values.pop("axis")),
            planes=tuple(_plane(plane) for plane in values.pop("planes")),
            candidates=tuple(
                Candidate(_plane(c["plane"]), float(c["score"]), c["exactness"]) for c in values.pop("candidates")
            ),
            uncertainty=_uncertainty(values.pop("uncertainty")),
            pairs=Pairs(
                np.array(pairs["x"], dtype=float).reshape(-1, 3),
                np.array(pairs["y"], dtype=float).reshape(-1, 3),
                np.array(pairs["rows"], dtype=np.int64).reshape(-1, 2),
                np.array(pairs["weight"], dtype=float),
            ),
            used=np.array(values.pop("used"), dtype=np.int64),
            notes=tuple(values.pop("notes")),
            points=None if points is None else np.asarray(points, dtype=float),
            **values,
        )
    except (KeyError, TypeError, ValueError) as error:
        raise FileFormatError(f"{path} is no complete detection: {error}") from error


def _plane(values: dict[str, Any]) -> Plane:
    normal, offset = (np.array(values[name], dtype=float) for name in ("normal", "offset"))
    return Plane(normal.reshape(3), offset.reshape(()))


def _arrays(values: list[list[float]] | None) -> Any:
    return None if values is None else tuple(np.array(value, dtype=float).reshape(3) for value in values)


def _uncertainty(values: dict[str, Any] | None) -> Uncertainty | None:
    if values is None:
        return None
    shapes = {"covariance": (3, 3), "tangents": (2, 3), "centre": (3,)}
    return Uncertainty(**{name: np.array(values[name], dtype=float).reshape(s) for name, s in shapes.items()})


def _plain(value: Any) -> Any:
    """NumPy and named tuples as what JSON knows."""
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    return value
