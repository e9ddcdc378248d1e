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
from symjax.preprocess.own_frame import OwnFrame, in_own_frame
from symjax.preprocess.thinning import distinct, evenly, on_grid
from symjax.preprocess.validation import MIN_POINTS, as_normals, as_points, finite_rows, require

MAX_POINTS = 10_000
"""More points than this are thinned: the plane of 10 000 is more exact than most objects are symmetric."""

DENSITY_POINTS = 30_000
"""Points among which outliers are looked for, if no more are to be kept: they are drawn evenly from a larger cloud,
since a grid would make all densities alike."""

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
    rows: Int[np.ndarray, " n"]
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
    own = _own_frame_of_cloud(given[index])
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
        own = _own_frame_of_cloud(given[index])
        rows = np.argsort(own.points[:, 0], kind="stable")
    if own.rank == 2:
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
) -> Int[np.ndarray, " m"]:
    """Rows of the points that are neither outliers nor ground."""
    rows = np.arange(len(points))
    if drop_outliers:
        outlier = scattered(points)
        # so few that a plane could not be looked for are no surface that outliers hide
        outlier &= np.count_nonzero(~outlier) >= MIN_POINTS
        rows = _without(rows, outlier, "are scattered outliers and were left out", notes)
    if remove_ground:
        rows = _without(rows, ground_rows(points[rows]), "lie on the ground plane and were left out", notes)
    return rows


def _without(
    rows: Int[np.ndarray, " n"], dropped: Bool[np.ndarray, " n"], why: str, notes: list[str]
) -> Int[np.ndarray, " m"]:
    if dropped.any():
        notes.append(f"{np.count_nonzero(dropped)} of {len(rows)} points {why}")
    return rows[~dropped]


def _own_frame_of_cloud(points: Float[np.ndarray, "n 3"]) -> OwnFrame:
    own = in_own_frame(points)
    if own.rank < 2:
        raise DegenerateCloudError(f"the {len(points)} points lie on one line: no mirror plane is defined")
    return own


def _warn_of_precision(points: ArrayLike, own: OwnFrame) -> None:
    offset = float(np.abs(own.to_given.shift).max())
    if np.asarray(points).dtype == np.float32 and offset / own.extent > FAR_FOR_FLOAT32:
        warnings.warn(
            f"float32 points {offset / own.extent:.0e} times their extent away from the origin have lost most of "
            "their digits: subtract their mean before storing them, or use float64",
            PrecisionWarning,
            stacklevel=4,
        )
