"""The cloud: points checked, in their own frame and units, without duplicates, and thinned where there are too many."""

import warnings
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import ArrayLike

from symjax.errors import DegenerateCloudError, PrecisionWarning
from symjax.geometry import checks
from symjax.geometry.similarity import Similarity
from symjax.preprocess.ground import ground_rows
from symjax.preprocess.outliers import scattered
from symjax.preprocess.thinning import distinct, evenly, on_grid
from symjax.preprocess.validation import MIN_POINTS, as_normals, as_points, finite_rows, require

MAX_POINTS = 10_000
"""More points than this are thinned: the plane of 10 000 is more exact than most objects are symmetric."""

DENSITY_POINTS = 30_000
"""Points among which outliers are looked for, if no more are to be kept: they are drawn evenly from a larger cloud,
since a grid would make all densities alike."""

FLAT = 1e-6
"""Ratio of singular values below which a cloud counts as collinear or coplanar."""

FAR_FOR_FLOAT32 = 1e5


class Cloud(NamedTuple):
    """Points in their own frame, in units of their diagonal, in an order of their own; and the way back.

    The frame is the principal one about the mean, each axis turned to where the points reach further (the sign of the
    third moment). A cloud that was turned, mirrored, moved, scaled or shuffled comes out as the same numbers but for
    rounding, and so do all answers: a triangulation of overlapping stars, for one, depends on the order of its points.

    Attributes:
        points: the points, sorted along the first axis.
        normals: surface normals of the points, of any length and either orientation, if they were given.
        rows: their row in the given array.
        to_given: from the cloud's frame and units to those of the given points; `to_given.scale` is the length of the
            principal box's diagonal, and `to_given.shift` the mean of the points.
        num_given: rows of the given array.
        cleaned: whether outliers or a ground plane were left out.
        notes: what was dropped, merged, thinned or found, as sentences.
    """

    points: Float[np.ndarray, "n 3"]
    normals: Float[np.ndarray, "n 3"] | None
    rows: Int[np.ndarray, "n"]
    to_given: Similarity
    num_given: int
    cleaned: bool
    notes: tuple[str, ...]

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of the cloud's box in its own frame, in the units of the given points."""
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
    """Checks, centres, scales, merges and thins a cloud.

    Args:
        points: (n, 3) real numbers in any units, anywhere.
        normals: (n, 3) surface normals, of any length and either orientation.
        nonfinite: `"raise"`, or `"drop"` rows with NaN or infinity and say so.
        max_points: larger clouds are thinned to at most this many, deterministically and whatever their pose.
        drop_outliers: leave out the points that lie in space and not on a surface (see `symjax.preprocess.outliers`),
            so that frame and scale are those of the surface.
        remove_ground: leave out the dominant plane that a scan stands on (see `symjax.preprocess.ground`).

    Raises:
        InvalidPointsError: no (n, 3) array of real numbers, or normals that are no normals of these points.
        NonfiniteError: NaN or infinity, with `nonfinite="raise"`.
        TooFewPointsError: fewer than 50 distinct points.
        DegenerateCloudError: the points coincide or lie on one line.
        InvalidArgumentError: an option is out of its range.
    """
    checks.choice("nonfinite", nonfinite, ("raise", "drop"))
    max_points = checks.whole("max_points", max_points, MIN_POINTS)
    checks.flag("drop_outliers", drop_outliers)
    checks.flag("remove_ground", remove_ground)
    given = as_points(points)
    notes: list[str] = []
    index = finite_rows(given, nonfinite, notes)
    require(len(index), "points")
    own = _in_own_frame(given[index])
    _warn_of_precision(points, own)
    rows = np.argsort(own.points[:, 0], kind="stable")
    cleaned = False
    if drop_outliers or remove_ground:
        most = max(DENSITY_POINTS, max_points)
        if len(rows) > most:
            sought = " and ".join(["outliers"] * drop_outliers + ["the ground"] * remove_ground)
            notes.append(f"the search for {sought} used {most} of {len(rows)} points, drawn evenly")
        rows = rows[evenly(len(rows), most)]
        rows = rows[distinct(own.points[rows], notes)]
        kept = rows[_kept(own.points[rows], notes, drop_outliers=drop_outliers, remove_ground=remove_ground)]
        cleaned = len(kept) < len(rows)
        index = index[kept]
        require(len(index), "points that are neither outliers nor ground")
        # once more: the frame and the scale of the surface alone
        own = _in_own_frame(given[index])
        rows = np.argsort(own.points[:, 0], kind="stable")
    if own.flat:
        notes.append("the points are coplanar: their own plane is a trivial mirror and is left out")
    if len(rows) > max_points:
        rows = rows[on_grid(own.points[rows], max_points)]
        notes.append(f"thinned from {len(given)} to {len(rows)} points on a grid")
    if not (drop_outliers or remove_ground):
        rows = rows[distinct(own.points[rows], notes)]
    require(len(rows), "distinct points")
    of_points = None
    if normals is not None:
        of_points = np.asarray(own.to_given.inverse().directions(as_normals(normals, given.shape, index[rows])))
    return Cloud(own.points[rows], of_points, index[rows], own.to_given, len(given), cleaned, tuple(notes))


def _kept(
    points: Float[np.ndarray, "n 3"], notes: list[str], *, drop_outliers: bool, remove_ground: bool
) -> Int[np.ndarray, "m"]:
    """Rows of the points that are neither outliers nor ground."""
    rows = np.arange(len(points))
    if drop_outliers:
        outlier = scattered(points)
        # so few that a plane could not be looked for are no surface that outliers hide
        outlier &= np.count_nonzero(~outlier) >= MIN_POINTS
        rows = _without(rows, outlier, "are scattered outliers and were left out", notes)
    ground = ground_rows(points[rows]) if remove_ground else None
    if ground is not None:
        rows = _without(rows, ground.rows, "lie on the ground plane and were left out", notes)
    return rows


def _without(
    rows: Int[np.ndarray, "n"], dropped: Bool[np.ndarray, "n"], why: str, notes: list[str]
) -> Int[np.ndarray, "m"]:
    if dropped.any():
        notes.append(f"{np.count_nonzero(dropped)} of {len(rows)} points {why}")
    return rows[~dropped]


class _OwnFrame(NamedTuple):
    """Points in their principal frame about their mean, in units of their diagonal; and the way back."""

    points: Float[np.ndarray, "n 3"]
    to_given: Similarity
    extent: float
    flat: bool


def _in_own_frame(values: Float[np.ndarray, "n 3"]) -> _OwnFrame:
    centre, extent = _middle(values)
    if extent == 0:
        raise DegenerateCloudError(f"all {len(values)} points coincide: no mirror plane is defined")
    unit = (values - centre) / extent
    singular, frame = _principal_frame(unit)
    if singular[1] < FLAT * singular[0]:
        raise DegenerateCloudError(f"the {len(values)} points lie on one line: no mirror plane is defined")
    own = unit @ frame
    sign = np.where((own**3).sum(axis=0) < 0, -1.0, 1.0)
    frame, own = frame * sign, own * sign
    diagonal = float(np.linalg.norm(np.ptp(own, axis=0)))
    flat = bool(singular[2] < FLAT * singular[0])
    return _OwnFrame(own / diagonal, Similarity(diagonal * extent, frame, centre), extent, flat)


def _warn_of_precision(points: ArrayLike, own: _OwnFrame) -> None:
    offset = float(np.abs(own.to_given.shift).max())
    if np.asarray(points).dtype == np.float32 and offset / own.extent > FAR_FOR_FLOAT32:
        warnings.warn(
            f"float32 points {offset / own.extent:.0e} times their extent away from the origin have lost most of "
            "their digits: subtract their mean before storing them, or use float64",
            PrecisionWarning,
            stacklevel=4,
        )


def _middle(points: Float[np.ndarray, "n 3"]) -> tuple[Float[np.ndarray, "3"], float]:
    """Mean and largest coordinate distance from it, for coordinates whose squares or sums may overflow."""
    largest = float(np.abs(points).max())
    if largest == 0:
        return np.zeros(3), 0.0
    # a power of two, so that scaling rounds nothing; halved, so that differences stay finite
    scale = 2.0 ** min(np.frexp(largest)[1] + 1, 1023)
    small = points / scale
    centre = small.mean(axis=0)
    return centre * scale, float(np.abs(small - centre).max()) * scale


def _principal_frame(
    points: Float[np.ndarray, "n 3"],
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
    """Singular values, descending, and the principal axes in columns."""
    _, singular, axes = np.linalg.svd(np.linalg.qr(points, mode="r"))
    return singular, axes.T
