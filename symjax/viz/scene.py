"""The scene that the page and the PNG image of a detection both draw, and their headline."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Shaped

from symjax.errors import InvalidArgumentError, TooFewPointsError
from symjax.geometry.plane import Plane
from symjax.geometry.similarity import Similarity
from symjax.viz.drawable import Drawable

AZIMUTH, ELEVATION = np.radians(27.0), np.radians(20.0)
"""Angle of the view direction to the plane, about the up direction, and its elevation above the horizon. They make both
halves of the object and the face of the plane visible."""

AMBIGUITY = {
    "axis": "every plane through the axis is equally good",
    "sphere": "every plane through the centre is equally good",
}
"""End of the headline of an ambiguous detection, by its symmetry."""

OTHER_AMBIGUITY = "other planes are equally good"
"""The same for all other symmetries."""

MARGIN = 1.08
"""Size of the plane's quad, relative to the extent of the cloud."""

MIN_HALF_SIDE = 0.15
"""Smallest half-side of the quad, as a fraction of the cloud's size, so that the plane of a flat cloud is visible."""


class View(NamedTuple):
    """Orthonormal frame of the picture.

    Attributes:
        right: direction to the right.
        up: upward direction.
        towards: direction towards the viewer.
    """

    right: Float[np.ndarray, " 3"]
    up: Float[np.ndarray, " 3"]
    towards: Float[np.ndarray, " 3"]


class Scene(NamedTuple):
    """A detection that is ready to draw. All coordinates but `origin` are relative to `origin`.

    A cloud far from the origin of its coordinates therefore keeps its precision.

    Attributes:
        origin: centre of the cloud.
        size: diagonal of the cloud's bounding box.
        cloud: points on the object.
        mirrored: mirror images of the points.
        removed: points that were removed: outliers and the ground plane.
        plane: the mirror plane.
        quad: corners of the quad that represents the plane.
        others: corners of the quads of the other candidates.
        x: first point of each drawn pair.
        y: second point of each drawn pair.
        weight: how well each drawn pair agrees with the plane, 0 to 1.
        is_inlier: whether each drawn pair is an inlier.
        num_inliers: number of inliers among all pairs.
        num_pairs: number of all pairs.
        view: frame of the picture.
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
    """Thins and centres a detection, and chooses its view.

    Args:
        detection: the detection to draw. Points with NaN or infinite coordinates are not drawn.
        max_points: largest number of points to keep.
        max_pairs: largest number of pairs to keep.
        up: direction that points up in the picture; by default, the cloud's longest direction within the plane.

    Returns:
        The scene.

    Raises:
        TooFewPointsError: if the detection has no finite points, or was loaded from a file without its points.
        InvalidArgumentError: if `max_points` is below 1, or `up` is not a direction.
    """
    if max_points < 1:
        raise InvalidArgumentError(f"max_points must be at least 1, got {max_points}")
    if detection.points is None:
        raise TooFewPointsError("the detection was loaded without its points: pass them, as in load(path, points=...)")
    given = np.asarray(detection.points, dtype=np.float64)
    on_surface = detection.on_surface()
    points = given[on_surface]
    if not len(points):
        raise TooFewPointsError("the detection has no finite point to draw: run detect on the cloud again")
    removed = thin(given[~on_surface & np.isfinite(given).all(axis=1)], max_points)
    points = thin(points, max_points)
    low, high = robust_bounds(points)
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
    """Returns two lines: the plane's equation, and the evidence for it. All characters but the middle dot are ASCII."""
    normal = ", ".join(f"{component:z.4f}" for component in np.asarray(detection.plane.normal))
    name = "Mirror plane" if detection.found else "No mirror plane found; best candidate"
    evidence = f"Score {detection.score:.3f}"
    if detection.threshold is not None:
        relation = "above" if detection.score > detection.threshold else "not above"
        evidence += f", {relation} the threshold of {detection.threshold:.3f}"
        if relation == "above" and not detection.found:
            evidence += ", but refuted or not converged"
    if detection.inlier_fraction is not None:
        evidence += f"; {detection.inlier_fraction:.0%} of {len(detection.pairs.weight)} pairs are inliers"
    if detection.ambiguous:
        evidence += f"; ambiguous: {AMBIGUITY.get(detection.symmetry, OTHER_AMBIGUITY)}"
    return f"{name} ({normal}) · x = {float(detection.plane.offset):z.6g}", evidence


def thin(rows: Shaped[np.ndarray, "n ..."], max_rows: int) -> Shaped[np.ndarray, "m ..."]:
    """Keeps at most `max_rows` of the rows, in order. They are random, because a stride could keep whole scan lines."""
    if len(rows) <= max_rows:
        return rows
    return rows[np.sort(np.random.default_rng(0).choice(len(rows), max_rows, replace=False))]


def robust_bounds(coordinates: Float[np.ndarray, "n d"]) -> tuple[Float[np.ndarray, " d"], Float[np.ndarray, " d"]]:
    """Returns the lower and the upper corner of the box to show, which a few distant points do not enlarge much."""
    low, high = np.quantile(coordinates, (0.005, 0.995), axis=0)
    slack = 0.5 * (high - low)
    return (
        np.maximum(coordinates.min(axis=0), low - slack),
        np.minimum(coordinates.max(axis=0), high + slack),
    )


def bounds(scene: Scene, axes: Float[np.ndarray, "3 d"]) -> tuple[Float[np.ndarray, " d"], Float[np.ndarray, " d"]]:
    """Returns the lower and the upper corner of everything that is shown, along the axes in the columns of `axes`."""
    corners = [scene.quad @ axes, *robust_bounds(scene.cloud @ axes), *robust_bounds(scene.mirrored @ axes)]
    return np.vstack(corners).min(axis=0), np.vstack(corners).max(axis=0)


def _moved(plane: Plane, origin: Float[np.ndarray, " 3"]) -> Plane:
    """Returns the plane in coordinates relative to `origin`."""
    return Similarity(1.0, None, -origin).plane(Plane(*(np.asarray(part, dtype=np.float64) for part in plane)))


def _axes_within(
    plane: Plane, cloud: Float[np.ndarray, "n 3"], up: Sequence[float] | Float[np.ndarray, " 3"] | None
) -> Float[np.ndarray, "2 3"]:
    """Returns two axes within the plane: along the cloud's smallest and largest spread, or across and along `up`."""
    if up is not None:
        direction = np.asarray(up, dtype=np.float64)
        if direction.shape != (3,) or not np.isfinite(direction).all() or not direction.any():
            raise InvalidArgumentError(f"up must be three finite numbers that are not all zero, got {up!r}")
        along = direction - (direction @ plane.normal) * plane.normal
        # an `up` along the normal defines no direction within the plane
        if np.linalg.norm(along) > 1e-3 * np.linalg.norm(direction):
            along /= np.linalg.norm(along)
            return np.stack([_pointing_forward(np.cross(plane.normal, along)), along])
    basis = np.linalg.svd(plane.normal[None, :])[2][1:]
    shortest, longest = np.linalg.eigh(np.cov(cloud @ basis.T, rowvar=False, bias=True))[1].T @ basis
    return np.stack([_pointing_forward(shortest), _pointing_forward(longest)])


def _pointing_forward(axis: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """Flips the axis, if needed, so that its largest component is positive."""
    return axis if axis[np.abs(axis).argmax()] >= 0 else -axis


def _quad(
    plane: Plane, axes: Float[np.ndarray, "2 3"], cloud: Float[np.ndarray, "n 3"], size: float
) -> Float[np.ndarray, "4 3"]:
    """Returns the corners, in cyclic order, of the rectangle of the plane that spans the cloud."""
    low, high = robust_bounds(cloud @ axes.T)
    centre = (low + high) / 2
    half = np.maximum(MARGIN * (high - low) / 2, MIN_HALF_SIDE * size)
    corners = centre + half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    quad: Float[np.ndarray, "4 3"] = corners @ axes + plane.offset * plane.normal
    return quad


def _view(axes: Float[np.ndarray, "2 3"]) -> View:
    """Chooses a view along the plane, rotated so that its face is visible and raised so that its depth is."""
    depth, up = axes
    sideways = np.cos(AZIMUTH) * depth + np.sin(AZIMUTH) * np.cross(up, depth)
    towards = np.cos(ELEVATION) * sideways + np.sin(ELEVATION) * up
    right = np.cross(up, sideways)
    return View(right, np.cross(towards, right), towards)
