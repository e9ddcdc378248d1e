"""The pairs of a scale sweep, with the diagonal that σ is a fraction of."""

from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from symjax.errors import TooFewPointsError
from symjax.preprocess.cloud import prepare
from symjax.preprocess.cloud_frame import to_cloud_frame
from symjax.preprocess.validation import finite_rows
from symjax.symhks.correspondences import MIN_PAIRS, correspondences
from symjax.symhks.method import SymHKS

Nonfinite = Literal["raise", "drop"]


class SweepPairs(NamedTuple):
    """Putative mirror pairs, with the centre and size of their cloud.

    Attributes:
        x: first point of every pair, in the units of the file.
        y: second point of every pair.
        centre: mean of the cloud, or of the points of the pairs.
        diagonal: length of the diagonal of the bounding box along the principal axes.
        notes: the source of the pairs and what was done to the points, as sentences.
    """

    x: Float[np.ndarray, "n 3"]
    y: Float[np.ndarray, "n 3"]
    centre: Float[np.ndarray, " 3"]
    diagonal: float
    notes: tuple[str, ...]


def cloud_pairs(points: Float[np.ndarray, "n 3"], *, nonfinite: Nonfinite = "raise") -> SweepPairs:
    """Finds the correspondences of a cloud by Sym-HKS, as `detect(points, "sym-hks")` does.

    Args:
        points: the cloud, in any units.
        nonfinite: what to do with points that are NaN or infinite: `"raise"` an error, or `"drop"` them.

    Raises:
        SymjaxError: if no correspondences were found; the subclass and the message say why.
    """
    method = SymHKS()
    cloud = prepare(points, nonfinite=nonfinite, drop_outliers=method.drops_outliers)
    matches = correspondences(cloud.points, options=method)
    pairs = points[cloud.rows[matches.rows]]
    notes = (
        f"{len(pairs)} correspondences by Sym-HKS among {len(cloud.points)} points",
        *cloud.notes,
        *matches.notes,
    )
    return SweepPairs(pairs[:, 0], pairs[:, 1], np.asarray(cloud.to_given.shift), cloud.diagonal, notes)


def given_pairs(
    x: Float[np.ndarray, "n 3"], y: Float[np.ndarray, "n 3"], *, nonfinite: Nonfinite = "raise"
) -> SweepPairs:
    """Checks given pairs, and computes the centre and diagonal of their points.

    Args:
        x: first point of every pair, in any units.
        y: second point of every pair.
        nonfinite: what to do with pairs that are NaN or infinite: `"raise"` an error, or `"drop"` them.

    Raises:
        NonfiniteError: if a pair is NaN or infinite, with `nonfinite="raise"`.
        TooFewPointsError: if there are fewer than three pairs.
        DegenerateCloudError: if all points coincide.
    """
    notes: list[str] = []
    rows = finite_rows(np.concatenate([x, y], axis=1), nonfinite, notes, noun="pairs")
    if len(rows) < MIN_PAIRS:
        raise TooFewPointsError(f"{len(rows)} pairs are too few: at least {MIN_PAIRS} are needed to fit a plane")
    x, y = x[rows], y[rows]
    to_given = to_cloud_frame(np.concatenate([x, y]), "points of the pairs").to_given
    return SweepPairs(x, y, np.asarray(to_given.shift), float(to_given.scale), (f"{len(x)} pairs given", *notes))
