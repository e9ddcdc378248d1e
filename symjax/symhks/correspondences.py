"""Sym-HKS: putative mirror pairs of a cloud (Sec. 4 of the paper)."""

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
"""Fewer pairs do not fix a plane against one outlier."""


class Correspondences(NamedTuple):
    """Putative mirror pairs.

    Attributes:
        rows: rows of the two points of every pair in the cloud.
        spacing: median distance of the cloud's points from the nearest keypoint other than themselves: what
            separates a point's mirror image from the best possible match.
        notes: what was found, as sentences.
    """

    rows: Int[np.ndarray, "q 2"]
    spacing: float
    notes: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class CorrespondenceOptions:
    """Options of the correspondences. Where a default is not the paper's, its line says what the paper's is.

    Attributes:
        num_eigs: eigenfunctions k, the constant one included.
        laplacian: `"stars"`, the tufted Laplacian of our Delaunay stars; or `"library"`, the library's own routine.
        star_neighbours: neighbours offered to each Delaunay star.
        num_keypoints: keypoints, topped up by farthest-point samples; the paper takes those that it finds.
        radius: radius r of the neighbourhood of intrinsic shape signatures, as a fraction of the diagonal.
        num_neighbours: neighbours h that the radius may hold on the median; None does not bound them.
        num_times: diffusion times p.
        times: `"logarithmic"` (Sun et al.) or `"uniform"` (the paper).
        whitened: compare signatures by their Mahalanobis distance; False is the paper's plain distance.
        num_signs: low eigenfunctions in the sign vectors; 0 leaves the constraint out. The paper's s_i has one sign a
            keypoint, which is a misprint for one an eigenfunction; the highest of them change sign between neighbours,
            and say nothing.
        num_pairs: pairs q; None is `pairs_per_keypoint` times the keypoints.
        pairs_per_keypoint: q per keypoint, not printed in the paper: the better half of the keypoints, two in a pair.
            From 15 to 40 % the share of real models that were right changed by two or three in a hundred.
        separation: least distance of the two points of a pair, in spacings of the keypoints: points nearer than the
            residual's scale are one patch, and agree with any plane through it. 0 is the paper's, which leaves this
            to the signs alone.
        symmetric: the exact symmetric matching instead of the assignment; for at most 300 keypoints.
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
        """Raises InvalidArgumentError for an option out of its range."""
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
    """Putative mirror pairs of a cloud: spectrum, keypoints, signatures, assignment.

    Args:
        points: distinct points in units of their diagonal.
        normals: surface normals, of either orientation.
        options: see `CorrespondenceOptions`.
        timer: times the stages.

    Raises:
        SpectrumError: no eigenpairs.
        MatchingError: fewer than three pairs.
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
        notes.append(f"the cloud is in {eigen.num_components} pieces, between which no heat flows")
        warnings.warn(f"{notes[-1]}: correspondences across them are weak", ComponentsWarning, stacklevel=3)
    with timer.stage("keypoints"):
        found = keypoints(
            points,
            num_keypoints=options.num_keypoints,
            radius=options.radius,
            num_neighbours=options.num_neighbours,
        )
    if found.num_salient == 0:
        notes.append("no intrinsic shape signatures: all keypoints are farthest-point samples")
    with timer.stage("matching"):
        cost, penalty = _costs(points, eigen, found, options)
        num_pairs = options.num_pairs
        if num_pairs is None:
            num_pairs = min(round(options.pairs_per_keypoint * len(found.rows)), possible_pairs(cost, penalty=penalty))
        pairs = assign_pairs(cost, max(num_pairs, 1), symmetric=options.symmetric, penalty=penalty)
    if len(pairs) < MIN_PAIRS:
        raise MatchingError(
            f"{len(pairs)} mirror pairs among {len(found.rows)} keypoints are too few (at least {MIN_PAIRS}): "
            "raise num_keypoints or num_pairs"
        )
    return Correspondences(found.rows[pairs], found.spacing, tuple(notes))


def _costs(
    points: Float[np.ndarray, "n 3"], eigen: Spectrum, found: Keypoints, options: CorrespondenceOptions
) -> tuple[Float[np.ndarray, "a a"], float]:
    """The paper's a_ij, infinite for keypoints too near each other; and from where on a cost is prohibitive."""
    times = diffusion_times(eigen, num_times=options.num_times, scale=options.times)
    everywhere = heat_kernel_signatures(eigen, times)
    signatures = whiten(everywhere[found.rows], everywhere) if options.whitened else everywhere[found.rows]
    if options.num_signs:
        # the constant eigenfunction's sign is everybody's
        signs = sign_vectors(eigen, found.rows)[:, 1 : 1 + options.num_signs]
        # the paper's b, or more where unwhitened signatures differ by more
        penalty = max(SIGN_PENALTY, 2 * float(np.linalg.norm(np.ptp(signatures, axis=0))))
        cost = sign_penalty_cost(signatures, signs, penalty=penalty)
    else:
        cost, penalty = cdist(signatures, signatures), np.inf
    at = points[found.rows]
    cost[cdist(at, at) < options.separation * found.spacing] = np.inf
    return cost, penalty
