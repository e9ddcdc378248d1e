"""The cloud that a method gets: checked, in the cloud frame, without duplicates, and thinned if it is too large."""

import warnings
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import ArrayLike

from symjax.errors import DegenerateCloudError, PrecisionWarning
from symjax.geometry import checks
from symjax.geometry.point_arrays import as_points
from symjax.geometry.similarity import Similarity
from symjax.preprocess.cloud_frame import FramedPoints, to_cloud_frame
from symjax.preprocess.flatness import is_flat
from symjax.preprocess.ground import ground_mask
from symjax.preprocess.layers import Layers, layered_subset
from symjax.preprocess.outliers import outlier_mask
from symjax.preprocess.sheet_outliers import sheet_outlier_mask
from symjax.preprocess.thinning import distinct_rows, grid_subset, random_subset
from symjax.preprocess.validation import MIN_POINTS, as_normals, check_num_points, finite_rows

MAX_POINTS = 10_000
"""Larger clouds are thinned to this many points: 10 000 already give a plane more exactly than most objects are
symmetric."""

DENSITY_POINTS = 30_000
"""Points in which outliers and the ground plane are sought, unless `max_points` is larger. They are drawn at random
from a larger cloud, since a grid would make all densities alike."""

FAR_FOR_FLOAT32 = 1e5
"""Distance from the origin, in extents of the cloud, beyond which float32 points cause a warning."""

FLAT = "the points are coplanar apart from noise: their own plane is a trivial mirror plane and is not returned"


class Cloud(NamedTuple):
    """Points in the cloud frame and in a canonical order, and the map back to the given coordinates.

    The axes of the cloud frame are the principal axes about the mean, with signs that make the third moments positive.
    Lengths are in units of the diagonal. If the input points are rotated, reflected, shifted, scaled or permuted, the
    cloud stays the same up to rounding, and so do all results. The order matters: a triangulation of overlapping
    stars, for example, depends on it.

    Attributes:
        points: points, sorted along the first axis.
        normals: surface normals of the points, if they were given, with any nonzero length and either sign.
        rows: row of each point in the given array.
        to_given: map from the cloud frame to the given coordinates. `to_given.scale` is the diagonal, and
            `to_given.shift` is the mean of the points.
        num_given: number of rows of the given array.
        cleaned: whether outliers or a ground plane were removed.
        notes: what was removed, merged or thinned, as sentences.
        flat: whether the points lie in one sheet, apart from noise. The last axis of the frame is then its normal.
        layers: planes or lines on which the given points lie, in units of the diagonal; None if they do not. The points
            are then an evenly spread subset. Not looked for in flat clouds.

    Example:
        `detect` passes the cloud to the method, in which it is read like this:

        >>> import symjax
        >>> from symjax.preprocess.cloud import prepare
        >>> def extent(cloud: symjax.Cloud) -> np.ndarray:
        ...     return np.ptp(cloud.points, axis=0)
        >>> cloud = prepare(symjax.datasets.generate("block", num_points=300).points * 7)
        >>> print(f"{np.linalg.norm(extent(cloud)):.3f} diagonals")
        1.000 diagonals
    """

    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "n 3"] | None
    rows: Int[np.ndarray, " n"]
    to_given: Similarity
    num_given: int
    cleaned: bool
    notes: tuple[str, ...]
    flat: bool = False
    layers: Layers | None = None

    @property
    def diagonal(self) -> float:
        """Diagonal of the bounding box along the principal axes, in the units of the input points."""
        return float(self.to_given.scale)


def prepare(
    points: ArrayLike,
    *,
    normals: ArrayLike | None = None,
    nonfinite: Literal["raise", "drop"] = "raise",
    max_points: int = MAX_POINTS,
    drop_outliers: bool = False,
    remove_ground: bool = False,
) -> Cloud:
    """Prepares input points for a method: checks, cleans, centres, scales, merges and thins them.

    Args:
        points: (n, 3) real numbers in any units and at any position.
        normals: (n, 3) surface normals of any nonzero length and either sign.
        nonfinite: `"raise"` to raise an error for NaN or infinity, or `"drop"` to remove such points with a note.
        max_points: largest number of points; larger clouds are thinned, deterministically and independently of their
            pose.
        drop_outliers: whether to remove outliers first, so that they do not affect the cloud frame (see
            `symjax.preprocess.outliers`).
        remove_ground: whether to remove the plane that a scanned object stands on (see `symjax.preprocess.ground`).

    Returns:
        The cloud.

    Raises:
        InvalidPointsError: if `points` is not an (n, 3) array of real numbers, or `normals` are not normals of these
            points.
        NonfiniteError: if a point is NaN or infinite and `nonfinite` is `"raise"`.
        TooFewPointsError: if fewer than 50 distinct points are left.
        DegenerateCloudError: if the points coincide or lie on one line.
        InvalidArgumentError: if an option is out of its range.

    Example:
        >>> points = np.random.default_rng(0).normal(size=(100, 3)) * [3, 2, 1]
        >>> cloud = prepare(points)
        >>> cloud.points.shape
        (100, 3)
        >>> np.allclose(cloud.to_given.points(cloud.points), points[cloud.rows])
        True
    """
    checks.choice("nonfinite", nonfinite, ("raise", "drop"))
    max_points = checks.whole("max_points", max_points, MIN_POINTS)
    checks.flag("drop_outliers", drop_outliers)
    checks.flag("remove_ground", remove_ground)
    given = as_points(points, least=MIN_POINTS)
    notes: list[str] = []
    index = finite_rows(given, nonfinite, notes)
    check_num_points(len(index), "points")
    framed = _framed_points(given[index])
    _warn_about_precision(points, framed)
    rows = np.argsort(framed.points[:, 0], kind="stable")
    cleaned = False
    if drop_outliers or remove_ground:
        most = max(DENSITY_POINTS, max_points)
        if len(rows) > most:
            sought = " and ".join(["outliers"] * drop_outliers + ["the ground plane"] * remove_ground)
            notes.append(f"the search for {sought} used a random sample of {most} of the {len(rows)} points")
        rows = rows[random_subset(len(rows), most)]
        rows = rows[distinct_rows(framed.points[rows], notes)]
        kept = rows[_clean_rows(framed.points[rows], notes, drop_outliers=drop_outliers, remove_ground=remove_ground)]
        cleaned = len(kept) < len(rows)
        index = index[kept]
        check_num_points(len(index), "points that are neither outliers nor on the ground plane")
        # outliers and ground plane have changed the frame and the diagonal
        framed = _framed_points(given[index])
        rows = np.argsort(framed.points[:, 0], kind="stable")
    flat = is_flat(framed.points)
    if flat and drop_outliers:
        outlier = sheet_outlier_mask(framed.points[:, :2])
        outlier &= np.count_nonzero(~outlier) >= MIN_POINTS
        index = index[_without(np.arange(len(index)), outlier, "are outliers in the sheet and were removed", notes)]
        if outlier.any():
            cleaned = True
            framed = _framed_points(given[index])
            rows = np.argsort(framed.points[:, 0], kind="stable")
    if flat:
        notes.append(FLAT)
    if len(rows) > max_points:
        rows = rows[grid_subset(framed.points[rows], max_points)]
        notes.append(f"thinned from {len(given)} to {len(rows)} points on a grid")
    if not (drop_outliers or remove_ground):
        rows = rows[distinct_rows(framed.points[rows], notes)]
    check_num_points(len(rows), "distinct points")
    layers = None
    if not flat:
        subset, layers = layered_subset(framed.points[rows])
    if layers is not None:
        notes.append(layers.note)
        rows = rows[subset]
    of_points = None
    if normals is not None:
        of_points = np.asarray(framed.to_given.inverse().directions(as_normals(normals, given.shape, index[rows])))
    return Cloud(
        framed.points[rows], of_points, index[rows], framed.to_given, len(given), cleaned, tuple(notes), flat, layers
    )


def _clean_rows(
    points: Float[np.ndarray, "n 3"], notes: list[str], *, drop_outliers: bool, remove_ground: bool
) -> Int[np.ndarray, " m"]:
    """Finds the rows that are neither outliers nor on the ground plane."""
    rows = np.arange(len(points))
    if drop_outliers:
        outlier = outlier_mask(points)
        # fewer points than a cloud needs are no surface hidden among outliers
        outlier &= np.count_nonzero(~outlier) >= MIN_POINTS
        rows = _without(rows, outlier, "are outliers and were removed", notes)
    if remove_ground:
        rows = _without(rows, ground_mask(points[rows]), "lie on the ground plane and were removed", notes)
    return rows


def _without(
    rows: Int[np.ndarray, " n"], removed: Bool[np.ndarray, " n"], why: str, notes: list[str]
) -> Int[np.ndarray, " m"]:
    if removed.any():
        notes.append(f"{np.count_nonzero(removed)} of {len(rows)} points {why}")
    kept: Int[np.ndarray, " m"] = rows[~removed]
    return kept


def _framed_points(points: Float[np.ndarray, "n 3"]) -> FramedPoints:
    framed = to_cloud_frame(points)
    if framed.rank < 2:
        raise DegenerateCloudError(f"the {len(points)} points lie on one line, so they define no mirror plane")
    return framed


def _warn_about_precision(points: ArrayLike, framed: FramedPoints) -> None:
    distance = float(np.abs(framed.to_given.shift).max()) / framed.extent
    if np.asarray(points).dtype == np.float32 and distance > FAR_FOR_FLOAT32:
        warnings.warn(
            f"the points are float32 and lie {distance:.0e} times their extent from the origin, so most of their "
            "digits are lost: subtract their mean before storing them, or use float64",
            PrecisionWarning,
            stacklevel=4,
        )
