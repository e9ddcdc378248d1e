"""The pairs of a scale sweep, with the size that σ is a fraction of."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import TooFewPointsError
from symjax.preprocess.cloud import prepare
from symjax.preprocess.own_frame import in_own_frame
from symjax.preprocess.validation import finite_rows
from symjax.symhks.correspondences import MIN_PAIRS, correspondences
from symjax.symhks.method import SymHKS

Nonfinite = Literal["raise", "drop"]


class SweepPairs(NamedTuple):
    """Putative mirror pairs.

    Attributes:
        x: one end of every pair, in the units of the file.
        y: the other end.
        centre: middle of the cloud, or of the pairs.
        diagonal: of its box, in its principal frame.
        notes: where the pairs are from, and what was done to the points, as sentences.
    """

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    centre: Float[np.ndarray, " 3"]
    diagonal: float
    notes: tuple[str, ...]


def cloud_pairs(points: Float[np.ndarray, "n 3"], *, nonfinite: Nonfinite = "raise") -> SweepPairs:
    """The correspondences of a cloud by Sym-HKS, those of `detect(method="sym-hks")`.

    Args:
        points: the cloud, in any units.
        nonfinite: `"raise"`, or `"drop"` rows with NaN or infinity.

    Raises:
        SymjaxError: a cloud that has no correspondences; the subclass says why.
    """
    method = SymHKS()
    cloud = prepare(points, nonfinite=nonfinite, drop_outliers=method.drops_outliers)
    matches = correspondences(cloud.points, options=method)
    ends = points[cloud.rows[matches.rows]]
    notes = (f"{len(ends)} pairs by Sym-HKS among {len(cloud.points)} points", *cloud.notes, *matches.notes)
    return SweepPairs(ends[:, 0], ends[:, 1], np.asarray(cloud.to_given.shift), cloud.diagonal, notes)


def given_pairs(
    x: Float[np.ndarray, "n 3"], y: Float[np.ndarray, "n 3"], *, nonfinite: Nonfinite = "raise"
) -> SweepPairs:
    """Pairs that are known.

    Args:
        x: one end of every pair, in any units.
        y: the other end.
        nonfinite: `"raise"`, or `"drop"` pairs with NaN or infinity.

    Raises:
        NonfiniteError: NaN or infinity, with `nonfinite="raise"`.
        TooFewPointsError: fewer than three pairs.
        DegenerateCloudError: all ends are one point.
    """
    notes: list[str] = []
    rows = finite_rows(np.concatenate([x, y], axis=1), nonfinite, notes, noun="pairs")
    if len(rows) < MIN_PAIRS:
        raise TooFewPointsError(f"{len(rows)} pairs are too few: a plane takes {MIN_PAIRS} or more")
    x, y = x[rows], y[rows]
    to_given = in_own_frame(np.concatenate([x, y]), "ends of pairs").to_given
    return SweepPairs(x, y, np.asarray(to_given.shift), float(to_given.scale), (f"{len(x)} pairs given", *notes))
