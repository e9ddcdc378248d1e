"""The cloud: points checked, centred, scaled, without duplicates, and thinned where there are too many."""

import warnings
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import ArrayLike

from symjax.errors import DegenerateCloudError, DuplicatePointsWarning, InvalidArgumentError, PrecisionWarning
from symjax.preprocess.ground import floor_rows
from symjax.preprocess.outliers import scattered
from symjax.preprocess.validation import MIN_POINTS, as_points, finite_rows, require

MAX_POINTS = 10_000
"""More points than this are thinned: the plane of 10 000 is more exact than most objects are symmetric."""

DENSITY_POINTS = 30_000
"""Points among which outliers are looked for, drawn evenly from more: a grid would make all densities alike."""

COINCIDENT = 1e-9
"""Points closer than about this share of the diagonal count as one."""

FLAT = 1e-6
"""Ratio of singular values below which a cloud counts as collinear or coplanar."""

PERCENT_WORTH_A_WARNING = 1.0
FAR_FOR_FLOAT32 = 1e5


class Cloud(NamedTuple):
    """Points in their own frame, in units of their diagonal, in an order of their own; and the way back.

    The frame is the principal one about the mean, each axis turned to where the points reach further (the sign of the
    third moment). A cloud that was turned, mirrored, moved, scaled or shuffled comes out as the same numbers but for
    rounding, and so do all answers: a triangulation of overlapping stars, for one, depends on the order of its points.

    Attributes:
        points: the points, sorted along the first axis; the given ones are `centre + diagonal * points @ frame.T`.
        rows: their row in the given array.
        frame: orthonormal axes in columns, of either handedness.
        centre: mean of the given points.
        diagonal: length of the principal box's diagonal, in the given units.
        num_given: rows of the given array.
        cleaned: whether outliers or a floor were left out.
        notes: what was dropped, merged, thinned or found, as sentences.
    """

    points: Float[np.ndarray, "n 3"]
    rows: Int[np.ndarray, "n"]
    frame: Float[np.ndarray, "3 3"]
    centre: Float[np.ndarray, "3"]
    diagonal: float
    num_given: int
    cleaned: bool
    notes: tuple[str, ...]


def prepare(
    points: ArrayLike,
    *,
    nonfinite: Literal["raise", "drop"] = "raise",
    max_points: int = MAX_POINTS,
    drop_scattered: bool = False,
    drop_floor: bool = False,
) -> Cloud:
    """Check, centre, scale, merge and thin a cloud.

    Args:
        points: (n, 3) real numbers in any units, anywhere.
        nonfinite: `"raise"`, or `"drop"` rows with NaN or infinity and say so.
        max_points: larger clouds are thinned to at most this many, deterministically and whatever their pose.
        drop_scattered: leave out the points that lie in space and not on a surface (see `symjax.preprocess.outliers`), so that
            centre, frame and scale are those of the surface.
        drop_floor: leave out the dominant plane that a scan stands on (see `symjax.preprocess.ground`).

    Raises:
        InvalidPointsError: no (n, 3) array of real numbers.
        NonfiniteError: NaN or infinity, with `nonfinite="raise"`.
        TooFewPointsError: fewer than 50 distinct points.
        DegenerateCloudError: the points coincide or lie on one line.
        InvalidArgumentError: an option is out of its range.
    """
    if nonfinite not in ("raise", "drop"):
        raise InvalidArgumentError(f"nonfinite must be 'raise' or 'drop', not {nonfinite!r}")
    if max_points < MIN_POINTS:
        raise InvalidArgumentError(f"max_points must be at least {MIN_POINTS}, not {max_points}")
    given = as_points(points)
    notes: list[str] = []
    index = finite_rows(given, nonfinite, notes)
    require(len(index), "points")
    posed = _posed(given[index])
    _warn_of_precision(points, posed)
    rows = np.argsort(posed.points[:, 0], kind="stable")
    cleaned = False
    if drop_scattered or drop_floor:
        if len(rows) > DENSITY_POINTS:
            notes.append(f"{DENSITY_POINTS} of {len(rows)} points, drawn evenly, were looked at")
        rows = rows[_evenly(len(rows), DENSITY_POINTS)]
        rows = rows[_merge(posed.points[rows], notes)]
        num_looked_at = len(rows)
        if drop_scattered:
            stray = scattered(posed.points[rows])
            # so few that a plane could not be looked for are no surface that outliers hide
            stray &= np.count_nonzero(~stray) >= MIN_POINTS
            rows = _without(rows, stray, "are scattered outliers and were left out", notes)
        floor = floor_rows(posed.points[rows]) if drop_floor else None
        if floor is not None:
            rows = _without(rows, floor.rows, "lie on the floor and were left out", notes)
        cleaned = len(rows) < num_looked_at
        index = index[rows]
        require(len(index), "points that are neither outliers nor floor")
        posed = _posed(given[index])
        rows = np.argsort(posed.points[:, 0], kind="stable")
    if posed.flat:
        notes.append("the points are coplanar: their own plane is a trivial mirror and is left out")
    if len(rows) > max_points:
        rows = rows[_thin(posed.points[rows], max_points)]
        notes.append(f"thinned from {len(given)} to {len(rows)} points on a grid")
    if not (drop_scattered or drop_floor):
        rows = rows[_merge(posed.points[rows], notes)]
    require(len(rows), "distinct points")
    return Cloud(
        posed.points[rows],
        index[rows],
        posed.frame,
        posed.centre,
        posed.diagonal,
        len(given),
        cleaned,
        tuple(notes),
    )


def _without(
    rows: Int[np.ndarray, "n"], dropped: Bool[np.ndarray, "n"], why: str, notes: list[str]
) -> Int[np.ndarray, "m"]:
    if dropped.any():
        notes.append(f"{np.count_nonzero(dropped)} of {len(rows)} points {why}")
    return rows[~dropped]


class _Posed(NamedTuple):
    """Points in their principal frame about their mean, in units of their diagonal, and the way back."""

    points: Float[np.ndarray, "n 3"]
    frame: Float[np.ndarray, "3 3"]
    centre: Float[np.ndarray, "3"]
    diagonal: float
    extent: float
    flat: bool


def _posed(values: Float[np.ndarray, "n 3"]) -> _Posed:
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
    return _Posed(own / diagonal, frame, centre, diagonal * extent, extent, flat)


def _warn_of_precision(points: ArrayLike, posed: _Posed) -> None:
    offset = float(np.abs(posed.centre).max())
    if np.asarray(points).dtype == np.float32 and offset / posed.extent > FAR_FOR_FLOAT32:
        warnings.warn(
            f"float32 points {offset / posed.extent:.0e} times their extent away from the origin have lost most of "
            "their digits: subtract their mean before storing them, or use float64",
            PrecisionWarning,
            stacklevel=4,
        )


def _evenly(count: int, most: int) -> Int[np.ndarray, "m"]:
    """At most so many of the numbers below `count`, drawn by a fixed seed: what is thinned evenly keeps its density."""
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(0).choice(count, most, replace=False))


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


def _thin(points: Float[np.ndarray, "n 3"], max_points: int) -> Int[np.ndarray, "m"]:
    """One point a grid cell, the nearest to its centre, with the finest cells that leave at most `max_points`.

    The grid stands in the principal frame about the mean, so that it turns and mirrors with the cloud.
    """
    fine, coarse = 1e-4, 1.0
    for _ in range(12):
        middle = float(np.sqrt(fine * coarse))
        if len(np.unique(_cells(points, middle))) > max_points:
            fine = middle
        else:
            coarse = middle
    cells = _cells(points, coarse)
    off_centre = ((points / coarse - np.floor(points / coarse) - 0.5) ** 2).sum(axis=1)
    order = np.lexsort((off_centre, cells))
    first = np.r_[True, np.diff(cells[order]) != 0]
    return np.sort(order[first])


def _cells(points: Float[np.ndarray, "n 3"], size: float) -> Int[np.ndarray, "n"]:
    cell = np.floor(points / size).astype(np.int64) + 2**20
    return (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]


def _merge(points: Float[np.ndarray, "n 3"], notes: list[str]) -> Int[np.ndarray, "m"]:
    """Rows of the distinct points, in order."""
    keys = np.round(points / COINCIDENT).astype(np.int64)
    order = np.lexsort((np.arange(len(keys)), keys[:, 2], keys[:, 1], keys[:, 0]))
    new = np.r_[True, (np.diff(keys[order], axis=0) != 0).any(axis=1)]
    merged = int(np.count_nonzero(~new))
    if merged:
        notes.append(f"{merged} of {len(points)} points coincide with others and were merged")
    if 100 * merged > PERCENT_WORTH_A_WARNING * len(points):
        warnings.warn(notes[-1], DuplicatePointsWarning, stacklevel=4)
    return np.sort(order[new])
