"""Algorithm 1 of the paper as a method: correspondences by Sym-HKS, then the L2E estimator from several starts."""

from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

import numpy as np
from scipy.stats import chi2

from symjax.geometry import checks
from symjax.l2e.solvers.names import AnySolver, check_solver
from symjax.method.result import MethodResult
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import Cloud
from symjax.symhks.correspondences import CorrespondenceOptions, correspondences

INLIER_WEIGHT = float(np.exp(-0.5 * chi2.ppf(0.95, df=3)))
"""A pair is an inlier where its residual lies within the ball that holds 95 % of a Gaussian of scale σ."""

AS_GOOD = 0.95
"""Share of the best score from which on another candidate is as good: the pairs' own scatter."""

Starts = Literal["all", "rga", "pca", "l2"]


@dataclass(frozen=True, kw_only=True)
class SymHKS(CorrespondenceOptions):
    """The paper's Algorithm 1: mirror pairs by heat kernel signatures, made once, and their plane by L2E.

    The options of the correspondences are those of `CorrespondenceOptions`; these are the estimator's:

    Attributes:
        sigma: scale σ of the residual as a fraction of the cloud's diagonal; None is `sigma_spacings` times the
            keypoints' spacing.
        sigma_spacings: σ (not printed in the paper) in spacings of the keypoints. The keypoint nearest to a point's
            mirror image is one spacing off on the median, and the matched one is often a neighbour of that. From 1 to
            2.5 spacings the answers hardly change.
        starts: `"all"`: the robust Grassmann average of the paper first, then the principal direction, the
            least-squares plane, the planes of the best single pairs, and even directions. Or one of the first three
            alone: `"rga"`, `"pca"`, `"l2"`.
        restarts: number of starts, if they are `"all"`.
        solver: `"rbfgs"`, the paper's Riemannian BFGS; `"alternating"`, as the paper applies it; or another of
            `fit_plane`, such as a minimiser of optimistix: the same optimum.

    Example:
        >>> SymHKS(restarts=8).restarts
        8
        >>> SymHKS.as_printed().times
        'uniform'
    """

    name: ClassVar[str] = "sym-hks"
    drops_outliers: ClassVar[bool] = False

    sigma: float | None = None
    sigma_spacings: float = 1.4
    starts: Starts = "all"
    restarts: int = 64
    solver: AnySolver = "rbfgs"

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError for an option out of its range."""
        super().__post_init__()
        if self.sigma is not None:
            checks.number("sigma", self.sigma, above=0)
        checks.number("sigma_spacings", self.sigma_spacings, above=0)
        checks.whole("restarts", self.restarts, 1)
        checks.choice("starts", self.starts, get_args(Starts))
        check_solver(self.solver)

    @classmethod
    def as_printed(cls) -> "SymHKS":
        """What the paper prints, where it prints something: it gives no number of keypoints or pairs, and no σ."""
        return cls(times="uniform", whitened=False, separation=0.0, restarts=1, solver="alternating")

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror plane of a cloud, see `Method.find`.

        Raises:
            SpectrumError: no eigenpairs.
            MatchingError: fewer than three pairs.
        """
        # what needs JAX is imported when a plane is fitted
        from symjax.symhks.plane_fit import fit_candidates

        matches = correspondences(cloud.points, normals=cloud.normals, options=self, timer=timer)
        sigma = self.sigma_spacings * matches.spacing if self.sigma is None else float(self.sigma)
        with timer.stage("fitting"):
            x, y = (cloud.points[matches.rows[:, end]] for end in (0, 1))
            fits = fit_candidates(x, y, sigma, starts=self.starts, restarts=self.restarts, solver=self.solver, rng=rng)
        best = fits.candidates[0]
        found = fits.converged and best.score > fits.threshold
        as_good = [c for c in fits.candidates if c.score > max(fits.threshold, AS_GOOD * best.score)]
        return MethodResult(
            candidates=fits.candidates,
            planes=tuple(c.plane for c in as_good) if found else (),
            symmetry="none" if not found else "one plane" if len(as_good) == 1 else "several planes",
            threshold=fits.threshold,
            ambiguous=found and len(as_good) > 1,
            rows=matches.rows,
            weight=fits.weight,
            inlier_weight=INLIER_WEIGHT,
            inlier_fraction=float(np.mean(fits.weight >= INLIER_WEIGHT)),
            sigma=sigma,
            converged=fits.converged,
            message=fits.message,
            notes=matches.notes,
        )
