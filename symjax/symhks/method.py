"""The paper's Algorithm 1 as a method: correspondences by Sym-HKS, then the L2E estimator from several starts."""

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
"""A pair is an inlier if its residual is within the ball that contains 95 % of a Gaussian of scale σ."""

AS_GOOD = 0.95
"""A candidate with more than this fraction of the best score is as good: the pairs scatter by as much."""

Starts = Literal["all", "rga", "pca", "l2"]


@dataclass(frozen=True, kw_only=True)
class SymHKS(CorrespondenceOptions):
    """The paper's Algorithm 1: correspondences by heat kernel signatures (Sec. 4), and their plane by L2E (Eq. 5).

    The correspondences are computed once and then fixed. The method is made for complete, clean surfaces; `Robust` is
    for clouds with outliers, missing parts and noise. Some defaults differ from the paper; the reasons are in
    `symjax.symhks.correspondences.CorrespondenceOptions`, and `as_printed` returns the paper's settings.

    Attributes:
        num_eigs: number of eigenfunctions k, including the constant one.
        laplacian: `"stars"`, the tufted Laplacian of our own Delaunay stars; or `"library"`, the point-cloud routine of
            the library `robust_laplacian`.
        star_neighbours: number of neighbours from which each Delaunay star is built.
        num_keypoints: number of keypoints.
        radius: neighbourhood radius r of the intrinsic shape signatures, as a fraction of the diagonal.
        num_neighbours: limit h on the median number of neighbours within the radius; None sets no limit.
        num_times: number of diffusion times p.
        times: spacing of the diffusion times, `"logarithmic"` or `"uniform"`.
        whitened: whether signatures are compared by their Mahalanobis distance instead of the Euclidean distance.
        num_signs: number of low eigenfunctions in the sign vectors; 0 omits the sign constraint.
        num_pairs: number of pairs q; None means `pairs_per_keypoint` times the number of keypoints.
        pairs_per_keypoint: q per keypoint.
        separation: least distance between the two points of a pair, in spacings of the keypoints.
        symmetric: whether to solve the exact symmetric matching; for at most 300 keypoints.
        sigma: scale σ of the residual as a fraction of the cloud's diagonal; None means `sigma_spacings` times the
            spacing of the keypoints.
        sigma_spacings: σ in spacings of the keypoints (the paper gives no σ). The median distance from a mirror image
            to the nearest keypoint is one spacing, and the matched keypoint is often a neighbour of the nearest one.
            Between 1 and 2.5 spacings the results hardly change.
        starts: `"all"`, or one start by name: `"rga"`, the robust Grassmann average of the mid-points (the paper's);
            `"pca"`, their least principal direction; `"l2"`, the least-squares plane. `"all"` tries these three, then
            planes of the best single pairs and evenly spread directions.
        restarts: number of starts for `starts="all"`.
        solver: `"rbfgs"`, Riemannian BFGS (the paper's); `"alternating"`, as the paper applies it; or another solver
            of `fit_plane`, such as a minimiser of optimistix. All reach the same optimum.

    Example:
        >>> import dataclasses
        >>> import symjax
        >>> method = symjax.SymHKS(sigma=0.05, restarts=16)
        >>> dataclasses.replace(method, solver="irls").solver
        'irls'
        >>> symjax.SymHKS.as_printed().times
        'uniform'
        >>> symjax.SymHKS(sigma=0)
        Traceback (most recent call last):
        symjax.errors.InvalidArgumentError: sigma must be ...
    """

    name: ClassVar[str] = "sym-hks"
    drops_outliers: ClassVar[bool] = False

    sigma: float | None = None
    sigma_spacings: float = 1.4
    starts: Starts = "all"
    restarts: int = 64
    solver: AnySolver = "rbfgs"

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError if an option is out of range."""
        super().__post_init__()
        if self.sigma is not None:
            checks.number("sigma", self.sigma, above=0)
        checks.number("sigma_spacings", self.sigma_spacings, above=0)
        checks.whole("restarts", self.restarts, 1)
        checks.choice("starts", self.starts, get_args(Starts))
        check_solver(self.solver)

    @classmethod
    def as_printed(cls) -> "SymHKS":
        """Returns the settings that the paper prints.

        Three choices remain that are not the paper's: the Laplacian `"stars"`, where the paper uses the library's
        point-cloud routine; `num_signs=12` instead of all eigenfunctions; and 500 keypoints, at least half of them
        farthest-point samples, where the paper has intrinsic shape signatures only. The paper gives no number of
        keypoints or pairs, and no σ: they have our defaults.
        """
        return cls(times="uniform", whitened=False, separation=0.0, restarts=1, solver="alternating")

    def find(self, cloud: Cloud, *, max_planes: int, rng: np.random.Generator, timer: StageTimer) -> MethodResult:
        """Finds the mirror plane of a cloud; `symjax.detect` calls it.

        Args:
            cloud: distinct points in the cloud frame, in units of the diagonal.
            max_planes: not used; `detect` keeps the first `max_planes` candidates.
            rng: draws the random planes that the threshold is derived from.
            timer: times the stages.

        Returns:
            The distinct optima as candidates, with their scores, and the pairs.

        Raises:
            SpectrumError: if the eigenpairs could not be computed.
            MatchingError: if fewer than three pairs were found.
        """
        # JAX is imported only now, when it is needed
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
