"""From points to their mirror plane: the bridge between the cloud's NumPy and the estimator's JAX."""

import os
from collections.abc import Callable
from typing import Literal

import numpy as np
from jaxtyping import ArrayLike, Float
from scipy.stats import chi2

from symjax.cloud import MAX_POINTS, Cloud, as_points, prepare
from symjax.correspondences import SymHKS, sym_hks
from symjax.detection import Detection, Pairs
from symjax.errors import InvalidArgumentError, InvalidPointsError
from symjax.files.pointfile import read_points
from symjax.fit import SOLVERS
from symjax.plane import Plane
from symjax.search import search
from symjax.stages import Stages

METHODS = ("sym-hks",)

SIGMA_SPACINGS = 1.4
"""Scale σ of the residual (not printed in the paper) in spacings of the keypoints, where it is not given. The keypoint
nearest to a point's mirror image is one spacing off on the median, and the matched one is often a neighbour
of that. From 1 to 2.5 spacings the answers hardly change."""

INLIER_WEIGHT = float(np.exp(-0.5 * chi2.ppf(0.95, df=3)))
"""A pair is an inlier where its residual lies within the ball that holds 95 % of a Gaussian of scale σ."""

RESTARTS = 64
"""Starts of the estimator, the paper's among them."""


def detect(
    points: Float[ArrayLike, "n 3"] | str | os.PathLike[str],
    method: str = "sym-hks",
    *,
    normals: Float[ArrayLike, "n 3"] | None = None,
    rng: int | np.random.Generator = 0,
    sigma: float | None = None,
    restarts: int = RESTARTS,
    solver: str = "joint",
    options: SymHKS | None = None,
    nonfinite: Literal["raise", "drop"] = "raise",
    max_points: int = MAX_POINTS,
    progress: Callable[[str], None] | None = None,
) -> Detection:
    """Finds the plane of reflection symmetry of a point cloud by the paper's Algorithm 1.

    Correspondences by Sym-HKS, then the L2E estimator from several starts. Everything is computed in float64;
    JAX's global precision is left alone.

    Args:
        points: the cloud, in any units and anywhere; or a file of it.
        method: `"sym-hks"`.
        normals: surface normals of the points, of either orientation; estimated where not given.
        rng: seed, or generator, of the random planes that the score is compared with (and of the sampling, where
            the file is a mesh).
        sigma: scale σ of the residual as a fraction of the cloud's diagonal; None takes it from the keypoints'
            spacing.
        restarts: number of starts: the robust Grassmann average of the paper first, then the principal direction,
            the least-squares plane, the planes of the best single pairs, and even directions.
        solver: `"joint"`, or `"alternating"` as the paper has it: the same optimum, slower.
        options: of the correspondences.
        nonfinite: `"raise"`, or `"drop"` rows with NaN or infinity.
        max_points: larger clouds are thinned to this many.
        progress: called with the name of every stage as it begins.

    Raises:
        SymjaxError: bad input; the subclass says which (see `symjax.errors`).
    """
    if method not in METHODS:
        raise InvalidArgumentError(f"method {method!r} is unknown: choose one of {', '.join(METHODS)}")
    if solver not in SOLVERS:
        raise InvalidArgumentError(f"solver {solver!r} is unknown: choose one of {', '.join(SOLVERS)}")
    if sigma is not None and not (np.isfinite(sigma) and sigma > 0):
        raise InvalidArgumentError(f"sigma must be positive and finite, not {sigma}")
    if restarts < 1:
        raise InvalidArgumentError(f"restarts must be at least 1, not {restarts}")
    options = SymHKS() if options is None else options
    options.check()
    seed = int(rng) if isinstance(rng, (int, np.integer)) else None
    stages = Stages(progress)
    reading: tuple[str, ...] = ()
    if isinstance(points, (str, os.PathLike)):
        with stages("reading"):
            file = read_points(points, rng=0 if seed is None else seed)
        points, reading = file.points, (file.note,) if file.note else ()
    with stages("preparing"):
        cloud = prepare(points, nonfinite=nonfinite, max_points=max_points)
        given = as_points(points)
        normals = None if normals is None else _checked_normals(normals, given.shape)[cloud.rows] @ cloud.frame
    matches = sym_hks(cloud.points, normals=normals, options=options, stages=stages)
    sigma = SIGMA_SPACINGS * matches.spacing if sigma is None else float(sigma)
    with stages("fitting"):
        x, y = (cloud.points[matches.rows[:, end]] for end in (0, 1))
        answer = search(x, y, sigma, restarts=restarts, solver=solver, rng=np.random.default_rng(rng))
    candidates = tuple(c._replace(plane=_in_given_units(c.plane, cloud)) for c in answer.candidates)
    best, index = candidates[0], cloud.rows[matches.rows]
    return Detection(
        plane=best.plane,
        found=answer.converged and best.score > answer.threshold,
        score=best.score,
        threshold=answer.threshold,
        candidates=candidates,
        pairs=Pairs(given[index[:, 0]], given[index[:, 1]], index, answer.weight),
        inlier_fraction=float(np.mean(answer.weight >= INLIER_WEIGHT)),
        converged=answer.converged,
        message=answer.message,
        method=method,
        sigma=sigma,
        diagonal=cloud.diagonal,
        seed=seed,
        num_points=cloud.num_given,
        num_used=len(cloud.points),
        notes=(*reading, *cloud.notes, *matches.notes),
        timings=stages.seconds,
        points=given[np.isfinite(given).all(axis=1)],
    )


def _checked_normals(normals: ArrayLike, shape: tuple[int, ...]) -> Float[np.ndarray, "n 3"]:
    array = np.asarray(normals)
    if array.shape != shape or array.dtype.kind not in "fiu":
        raise InvalidPointsError(f"normals must be real numbers of shape {shape}, as the points, not {array.shape}")
    bad = ~np.isfinite(array).all(axis=1) | (np.abs(array).max(axis=1) == 0)
    if bad.any():
        raise InvalidPointsError(
            f"{int(bad.sum())} normals are zero, NaN or infinite, the first at index {int(np.argmax(bad))}: "
            "leave normals out and they are estimated"
        )
    return array.astype(float)


def _in_given_units(plane: Plane, cloud: Cloud) -> Plane:
    normal = cloud.frame @ plane.normal
    return Plane(normal, normal @ cloud.centre + cloud.diagonal * plane.offset).canonical()
