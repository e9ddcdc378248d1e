"""Sym-HKS: correspondences of a point cloud, that is, putative mirror pairs (paper, Sec. 4)."""

import warnings
from dataclasses import dataclass
from typing import NamedTuple, get_args

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial.distance import cdist

from symjax.errors import ComponentsWarning, MatchingError
from symjax.geometry import checks
from symjax.method.stage_timer import StageTimer
from symjax.symhks.assignment import SIGN_PENALTY, assign_pairs, check_symmetric, possible_pairs, sign_penalty_cost
from symjax.symhks.keypoints import NUM_KEYPOINTS, NUM_NEIGHBOURS, RADIUS, Keypoints, keypoints
from symjax.symhks.signatures import NUM_TIMES, TimeScale, diffusion_times, heat_kernel_signatures, sign_vectors, whiten
from symjax.symhks.spectrum import NUM_EIGS, STAR_NEIGHBOURS, LaplacianKind, Spectrum, spectrum

MIN_PAIRS = 3
"""With fewer pairs, one outlier pair determines the plane."""


class Correspondences(NamedTuple):
    """Putative mirror pairs.

    Attributes:
        rows: rows in the cloud of the two points of every pair.
        spacing: median distance from a point of the cloud to the nearest keypoint other than itself. It is the
            typical distance from the mirror image of a keypoint to its best possible match.
        notes: what was noticed, as sentences.
    """

    rows: Int[np.ndarray, "q 2"]
    spacing: float
    notes: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class CorrespondenceOptions:
    """Options of the correspondences. Where a default differs from the paper, the paper's value is named.

    Attributes:
        num_eigs: number of eigenfunctions k, including the constant one.
        laplacian: `"stars"`, the tufted Laplacian of our own Delaunay stars; or `"library"`, the point-cloud routine of
            the library `robust_laplacian`.
        star_neighbours: number of neighbours from which each Delaunay star is built.
        num_keypoints: number of keypoints. Farthest-point samples make up the number; the paper has no such samples.
        radius: neighbourhood radius r of the intrinsic shape signatures, as a fraction of the diagonal.
        num_neighbours: limit h on the median number of neighbours within the radius; None sets no limit.
        num_times: number of diffusion times p.
        times: spacing of the diffusion times: `"logarithmic"` (Sun et al.) or `"uniform"` (the paper).
        whitened: whether signatures are compared by their Mahalanobis distance; the paper uses the Euclidean distance.
        num_signs: number of low eigenfunctions in the sign vectors; 0 omits the sign constraint. The paper's s_i has
            one sign per keypoint, a misprint for one per eigenfunction. The signs of the highest eigenfunctions carry
            no information, since they change between neighbours.
        num_pairs: number of pairs q; None means `pairs_per_keypoint` times the number of keypoints.
        pairs_per_keypoint: q per keypoint, not given in the paper. The default matches the better half of the
            keypoints. Between 0.15 and 0.4, the fraction of real models with the right plane changed by 2 or 3 %.
        separation: least distance between the two points of a pair, in spacings of the keypoints. Points nearer to each
            other than the scale of the residual belong to one patch, and agree with any plane through it. The paper has
            no such limit (0): only the signs keep neighbours apart.
        symmetric: whether to solve the exact symmetric matching instead of the assignment; for at most 300 keypoints.
    """

    num_eigs: int = NUM_EIGS
    laplacian: LaplacianKind = "stars"
    star_neighbours: int = STAR_NEIGHBOURS
    num_keypoints: int = NUM_KEYPOINTS
    radius: float = RADIUS
    num_neighbours: int | None = NUM_NEIGHBOURS
    num_times: int = NUM_TIMES
    times: TimeScale = "logarithmic"
    whitened: bool = True
    num_signs: int = 12
    num_pairs: int | None = None
    pairs_per_keypoint: float = 0.25
    separation: float = 1.9
    symmetric: bool = False

    def __post_init__(self) -> None:
        """Raises InvalidArgumentError if an option is out of range."""
        least = {"num_eigs": 2, "star_neighbours": 3, "num_keypoints": 6, "num_times": 1, "num_signs": 0}
        for name, lowest in least.items():
            checks.whole(name, getattr(self, name), lowest)
        for name, lowest in (("num_pairs", MIN_PAIRS), ("num_neighbours", 1)):
            if getattr(self, name) is not None:
                checks.whole(name, getattr(self, name), lowest)
        checks.number("radius", self.radius, above=0, below=1)
        checks.number("separation", self.separation, least=0)
        checks.number("pairs_per_keypoint", self.pairs_per_keypoint, above=0, most=1)
        checks.choice("times", self.times, get_args(TimeScale))
        checks.choice("laplacian", self.laplacian, get_args(LaplacianKind))
        checks.flag("whitened", self.whitened)
        if checks.flag("symmetric", self.symmetric):
            check_symmetric(self.num_keypoints)


def correspondences(
    points: Float[np.ndarray, "n 3"],
    *,
    normals: Float[np.ndarray, "n 3"] | None = None,
    options: CorrespondenceOptions | None = None,
    timer: StageTimer | None = None,
) -> Correspondences:
    """Finds putative mirror pairs of a cloud: spectrum, keypoints, signatures, assignment.

    Args:
        points: distinct points, in units of their diagonal.
        normals: surface normals of either orientation; estimated if None.
        options: the options; None means the defaults.
        timer: times the stages.

    Returns:
        The pairs, in order of their cost.

    Raises:
        InvalidArgumentError: if there are too few points for the number of eigenfunctions.
        SpectrumError: if the eigenpairs could not be computed.
        MatchingError: if fewer than three pairs were found.
    """
    options = CorrespondenceOptions() if options is None else options
    timer = StageTimer() if timer is None else timer
    notes: list[str] = []
    with timer.stage("spectrum"):
        eigen = spectrum(
            points,
            normals=normals,
            num_eigs=options.num_eigs,
            num_neighbours=options.star_neighbours,
            laplacian=options.laplacian,
        )
    if eigen.num_components > 1:
        notes.append(f"the cloud has {eigen.num_components} connected components: no heat flows between them")
        warnings.warn(f"{notes[-1]}, and correspondences across them are unreliable", ComponentsWarning, stacklevel=3)
    with timer.stage("keypoints"):
        found = keypoints(
            points,
            num_keypoints=options.num_keypoints,
            radius=options.radius,
            num_neighbours=options.num_neighbours,
        )
    if found.num_salient == 0:
        notes.append("no salient keypoints were found: all keypoints are farthest-point samples")
    with timer.stage("matching"):
        cost, penalty = _costs(points, eigen, found, options)
        num_pairs = options.num_pairs
        if num_pairs is None:
            num_pairs = min(round(options.pairs_per_keypoint * len(found.rows)), possible_pairs(cost, penalty=penalty))
        pairs = assign_pairs(cost, max(num_pairs, 1), symmetric=options.symmetric, penalty=penalty)
    if len(pairs) < MIN_PAIRS:
        raise MatchingError(
            f"only {len(pairs)} mirror pairs were found among {len(found.rows)} keypoints; at least {MIN_PAIRS} are "
            "needed: raise num_keypoints or num_pairs"
        )
    return Correspondences(found.rows[pairs], found.spacing, tuple(notes))


def _costs(
    points: Float[np.ndarray, "n 3"], eigen: Spectrum, found: Keypoints, options: CorrespondenceOptions
) -> tuple[Float[np.ndarray, "a a"], float]:
    """Returns the paper's a_ij, infinite for keypoints too near each other, and the penalty at which costs prohibit."""
    times = diffusion_times(eigen, num_times=options.num_times, scale=options.times)
    of_cloud = heat_kernel_signatures(eigen, times)
    signatures = whiten(of_cloud[found.rows], of_cloud) if options.whitened else of_cloud[found.rows]
    if options.num_signs:
        # the first eigenfunction is constant: its sign is the same everywhere
        signs = sign_vectors(eigen, found.rows)[:, 1 : 1 + options.num_signs]
        # the paper's b, or more if unwhitened signatures differ by more
        penalty = max(SIGN_PENALTY, 2 * float(np.linalg.norm(np.ptp(signatures, axis=0))))
        cost = sign_penalty_cost(signatures, signs, penalty=penalty)
    else:
        cost, penalty = cdist(signatures, signatures), np.inf
    positions = points[found.rows]
    cost[cdist(positions, positions) < options.separation * found.spacing] = np.inf
    return cost, penalty
