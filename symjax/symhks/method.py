"""Algorithm 1 of the paper on a cloud: correspondences by Sym-HKS, then the L2E estimator from several starts."""

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from symjax.errors import InvalidArgumentError
from symjax.l2e.pairs.arguments import checked_name
from symjax.l2e.solvers.registry import SOLVERS
from symjax.method.result import Finding
from symjax.method.timer import Stages
from symjax.symhks.correspondences import SymHKS, sym_hks
from symjax.symhks.plane_fit import search

SIGMA_SPACINGS = 1.4
"""Scale σ of the residual (not printed in the paper) in spacings of the keypoints, where it is not given. The keypoint
nearest to a point's mirror image is one spacing off on the median, and the matched one is often a neighbour
of that. From 1 to 2.5 spacings the answers hardly change."""

INLIER_WEIGHT = float(np.exp(-0.5 * chi2.ppf(0.95, df=3)))
"""A pair is an inlier where its residual lies within the ball that holds 95 % of a Gaussian of scale σ."""

RESTARTS = 64
"""Starts of the estimator, the paper's among them."""

AS_GOOD = 0.95
"""Share of the best score from which on another candidate is as good: the pairs' own scatter."""


def check(options: SymHKS, sigma: float | None, restarts: int, solver: str) -> None:
    """Raises InvalidArgumentError for an option out of its range."""
    checked_name("solver", solver, SOLVERS)
    if sigma is not None and not (np.isfinite(sigma) and sigma > 0):
        raise InvalidArgumentError(f"sigma must be positive and finite, not {sigma}")
    if restarts < 1:
        raise InvalidArgumentError(f"restarts must be at least 1, not {restarts}")
    options.check()


def find(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None,
    options: SymHKS,
    sigma: float | None,
    restarts: int,
    solver: str,
    rng: np.random.Generator,
    stages: Stages,
) -> Finding:
    """Finds the mirror plane of a cloud in units of its diagonal.

    Args:
        points: distinct points.
        normals: surface normals, of either orientation.
        options: of the correspondences.
        sigma: scale σ of the residual; None takes it from the keypoints' spacing.
        restarts: number of starts.
        solver: see `fit_plane`.
        rng: draws the random planes that the score is compared with.
        stages: clock of the stages.
    """
    matches = sym_hks(points, normals=normals, options=options, stages=stages)
    sigma = SIGMA_SPACINGS * matches.spacing if sigma is None else float(sigma)
    with stages("fitting"):
        x, y = (points[matches.rows[:, end]] for end in (0, 1))
        answer = search(x, y, sigma, restarts=restarts, solver=solver, rng=rng)
    best = answer.candidates[0]
    found = answer.converged and best.score > answer.threshold
    as_good = [c for c in answer.candidates if c.score > max(answer.threshold, AS_GOOD * best.score)]
    return Finding(
        candidates=answer.candidates,
        threshold=answer.threshold,
        symmetry="none" if not found else "one plane" if len(as_good) == 1 else "several planes",
        ambiguous=found and len(as_good) > 1,
        axis=None,
        planes=tuple(c.plane for c in as_good) if found else (),
        rows=matches.rows,
        weight=answer.weight,
        inlier_fraction=float(np.mean(answer.weight >= INLIER_WEIGHT)),
        sigma=sigma,
        converged=answer.converged,
        message=answer.message,
        uncertainty=None,
        notes=matches.notes,
    )
