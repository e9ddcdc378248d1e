"""What the page and the picture of a detection share: view, plane's quad, pairs, headline."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from symjax.errors import InvalidArgumentError, TooFewPointsError
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity
from symjax.viz.drawable import Drawable

AZIMUTH, ELEVATION = np.radians(27.0), np.radians(20.0)
"""Turn of the view about the up direction, and its lift: both halves and the plane's face are seen."""

AS_GOOD = "others are as good"

OTHERS = {
    "axis": "all planes through an axis are as good",
    "sphere": "all planes through a centre are as good",
}
"""What the headline adds for an ambiguous detection, by its symmetry, in place of `AS_GOOD`."""

MARGIN = 1.08
"""The quad reaches this much further than the cloud does."""

SLIMMEST = 0.15
"""The quad's half-sides are at least this share of the cloud's size, so that a flat cloud's plane is seen."""


class View(NamedTuple):
    """An orthonormal frame of the picture: `right`, `up`, and `toward` the viewer."""

    right: Float[np.ndarray, " 3"]
    up: Float[np.ndarray, " 3"]
    toward: Float[np.ndarray, " 3"]


class Scene(NamedTuple):
    """A detection ready to draw, about `origin`, so that a distant cloud keeps its digits.

    Attributes:
        origin: middle of the cloud, in the given coordinates.
        size: of the cloud, the diagonal of its box.
        cloud: its points.
        mirrored: their mirror images.
        removed: the points that were removed: outliers, or a ground plane.
        plane: the mirror plane.
        quad: corners of its part that is shown.
        others: the same of the other candidates.
        x: one end of every pair that is drawn.
        y: the other end.
        weight: how well these pairs agree with the plane, 0 to 1.
        is_inlier: which of them count as agreeing.
        num_inliers: pairs that do, drawn or not.
        num_pairs: all pairs.
        view: from where it is seen.
    """

    origin: Float[np.ndarray, " 3"]
    size: float
    cloud: Float[np.ndarray, "n 3"]
    mirrored: Float[np.ndarray, "n 3"]
    removed: Float[np.ndarray, "s 3"]
    plane: Plane
    quad: Float[np.ndarray, "4 3"]
    others: tuple[Float[np.ndarray, "4 3"], ...]
    x: Float[np.ndarray, "m 3"]
    y: Float[np.ndarray, "m 3"]
    weight: Float[np.ndarray, " m"]
    is_inlier: Bool[np.ndarray, " m"]
    num_inliers: int
    num_pairs: int
    view: View


def build(
    detection: Drawable,
    *,
    max_points: int,
    max_pairs: int,
    up: Sequence[float] | Float[np.ndarray, " 3"] | None = None,
) -> Scene:
    """Thin, centre and frame a detection.

    Args:
        detection: what `symjax.detect` gave. Points that are not finite are not drawn.
        max_points: the most points of the cloud that are kept.
        max_pairs: the most pairs that are kept.
        up: what points up in the picture; by default the cloud's longest direction within the plane.

    Raises:
        TooFewPointsError: the detection holds no finite point; one that was loaded from a file may hold none.
        InvalidArgumentError: `max_points` is not positive, or `up` is not a direction.
    """
    if max_points < 1:
        raise InvalidArgumentError(f"max_points must be positive, got {max_points}: give at least 1")
    if detection.points is None:
        raise TooFewPointsError("the detection was loaded without its points: give them to load(path, points=...)")
    given = np.asarray(detection.points, dtype=np.float64)
    on_surface = detection.on_surface()
    points = given[on_surface]
    if not len(points):
        raise TooFewPointsError("the detection holds no finite point to draw: run detect on the cloud again")
    removed = thin(given[~on_surface & np.isfinite(given).all(axis=1)], max_points)
    points = thin(points, max_points)
    low, high = reach(points)
    origin = (low + high) / 2
    size = float(np.linalg.norm(high - low)) or 1.0

    cloud = points - origin
    plane = _moved(detection.plane, origin)
    axes = _axes_within(plane, cloud, up)
    weight = np.asarray(detection.pairs.weight)
    is_inlier = weight >= detection.inlier_weight
    chosen = thin(np.arange(len(weight)), max_pairs)
    return Scene(
        origin=origin,
        size=size,
        cloud=cloud,
        mirrored=np.asarray(plane.reflect(cloud)),
        removed=removed - origin,
        plane=plane,
        quad=_quad(plane, axes, cloud, size),
        others=tuple(
            _quad(other, _axes_within(other, cloud, up), cloud, size)
            for other in (_moved(candidate.plane, origin) for candidate in detection.candidates[1:])
        ),
        x=np.asarray(detection.pairs.x)[chosen] - origin,
        y=np.asarray(detection.pairs.y)[chosen] - origin,
        weight=weight[chosen],
        is_inlier=is_inlier[chosen],
        num_inliers=int(is_inlier.sum()),
        num_pairs=len(weight),
        view=_view(axes),
    )


def headline(detection: Drawable) -> tuple[str, str]:
    """The plane's equation, and a sentence on how far to trust it. ASCII but for the middle dot."""
    normal = ", ".join(f"{component:z.4f}" for component in np.asarray(detection.plane.normal))
    verdict = "Mirror plane" if detection.found else "No mirror plane found; best candidate"
    evidence = f"score {detection.score:.3f}"
    if detection.threshold is not None:
        relation = "above" if detection.score > detection.threshold else "not above"
        evidence += f", {relation} the threshold {detection.threshold:.3f}"
    if detection.inlier_fraction is not None:
        evidence += f"; {detection.inlier_fraction:.0%} of {len(detection.pairs.weight)} pairs agree"
    if detection.ambiguous:
        evidence += f"; one of several: {OTHERS.get(detection.symmetry, AS_GOOD)}"
    return f"{verdict} ({normal}) · x = {float(detection.plane.offset):z.6g}", evidence


def thin(rows: np.ndarray, most: int) -> np.ndarray:
    """At most `most` of the rows, in order; at random, as a stride would show the file's scan lines."""
    if len(rows) <= most:
        return rows
    return rows[np.sort(np.random.default_rng(0).choice(len(rows), most, replace=False))]


def reach(coordinates: Float[np.ndarray, "n d"]) -> tuple[Float[np.ndarray, " d"], Float[np.ndarray, " d"]]:
    """Lower and upper corner of the box worth showing: a few points far away do not shrink the rest."""
    low, high = np.quantile(coordinates, (0.005, 0.995), axis=0)
    slack = 0.5 * (high - low)
    return (
        np.maximum(coordinates.min(axis=0), low - slack),
        np.minimum(coordinates.max(axis=0), high + slack),
    )


def box(scene: Scene, axes: Float[np.ndarray, "3 d"]) -> tuple[Float[np.ndarray, " d"], Float[np.ndarray, " d"]]:
    """Lower and upper corner, along the axes in the columns, of all that is shown."""
    corners = [scene.quad @ axes, *reach(scene.cloud @ axes), *reach(scene.mirrored @ axes)]
    return np.vstack(corners).min(axis=0), np.vstack(corners).max(axis=0)


def _moved(plane: Plane, origin: Float[np.ndarray, " 3"]) -> Plane:
    """The same plane in coordinates taken from `origin`."""
    return Similarity(1.0, None, -origin).plane(Plane(*(np.asarray(part, dtype=np.float64) for part in plane)))


def _axes_within(
    plane: Plane, cloud: Float[np.ndarray, "n 3"], up: Sequence[float] | Float[np.ndarray, " 3"] | None
) -> Float[np.ndarray, "2 3"]:
    """Axes of the plane along the cloud's shortest and longest spread in it, or across and along `up`."""
    if up is not None:
        direction = np.asarray(up, dtype=np.float64)
        if direction.shape != (3,) or not np.isfinite(direction).all() or not direction.any():
            raise InvalidArgumentError(f"up must be three numbers, not all zero, got {up!r}")
        along = direction - (direction @ plane.normal) * plane.normal
        # along the normal, up gives no direction in the plane
        if np.linalg.norm(along) > 1e-3 * np.linalg.norm(direction):
            along /= np.linalg.norm(along)
            return np.stack([_pointing_forward(np.cross(plane.normal, along)), along])
    basis = np.linalg.svd(plane.normal[None, :])[2][1:]
    shortest, longest = np.linalg.eigh(np.cov(cloud @ basis.T, rowvar=False, bias=True))[1].T @ basis
    return np.stack([_pointing_forward(shortest), _pointing_forward(longest)])


def _pointing_forward(axis: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """The axis with its largest component positive."""
    return axis * np.sign(axis[np.abs(axis).argmax()])


def _quad(
    plane: Plane, axes: Float[np.ndarray, "2 3"], cloud: Float[np.ndarray, "n 3"], size: float
) -> Float[np.ndarray, "4 3"]:
    """Corners, in order around, of the plane's part that spans the cloud."""
    low, high = reach(cloud @ axes.T)
    centre = (low + high) / 2
    half = np.maximum(MARGIN * (high - low) / 2, SLIMMEST * size)
    corners = centre + half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return corners @ axes + plane.offset * plane.normal


def _view(axes: Float[np.ndarray, "2 3"]) -> View:
    """Look along the plane, turned so that its face is seen and lifted so that its depth is."""
    depth, up = axes
    sideways = np.cos(AZIMUTH) * depth + np.sin(AZIMUTH) * np.cross(up, depth)
    toward = np.cos(ELEVATION) * sideways + np.sin(ELEVATION) * up
    right = np.cross(up, sideways)
    return View(right, np.cross(toward, right), toward)
