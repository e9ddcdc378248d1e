"""Sym-HKS: heat kernel signatures, which a mirror twin shares, and the signs that tell twins from neighbours."""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import InvalidArgumentError
from symjax.geometry.checks import choice, whole
from symjax.symhks.spectrum import ZERO_EIGENVALUE, Spectrum

NUM_TIMES = 32
"""Diffusion times p (not printed in the paper): enough to tell 20 eigenfunctions' squares apart."""

NOISE_FLOOR = 1e-3
"""Directions in which whitened signatures vary less than this share of the widest carry sampling noise."""

TimeScale = Literal["logarithmic", "uniform"]


def diffusion_times(
    spectrum: Spectrum, *, num_times: int = NUM_TIMES, scale: TimeScale = "logarithmic"
) -> Float[np.ndarray, " p"]:
    """Diffusion times between the extremes of the spectrum, in squared units of the points.

    `"uniform"` is the paper's choice, evenly in [10 ln10/λ_k, 10 ln10/λ_2]; `"logarithmic"` is that of Sun et al.,
    "A Concise and Provably Informative Multi-Scale Signature Based on Heat Diffusion" (SGP 2009), evenly in the
    logarithm over [4 ln10/λ_k, 4 ln10/λ_2]. λ_2 is the smallest eigenvalue above rounding: a cloud in two pieces
    has a second zero, for which the printed range is infinite.

    Raises:
        InvalidArgumentError: an unknown scale, or a spectrum of zeros.
    """
    num_times = whole("num_times", num_times, 1)
    choice("the time scale", scale, get_args(TimeScale))
    positive = spectrum.eigenvalues[spectrum.eigenvalues * spectrum.area >= ZERO_EIGENVALUE]
    if not len(positive):
        raise InvalidArgumentError(f"none of the {len(spectrum.eigenvalues)} eigenvalues is positive")
    slowest, fastest = positive[0], positive[-1]
    if scale == "uniform":
        return np.linspace(10 * np.log(10) / fastest, 10 * np.log(10) / slowest, num_times)
    return np.geomspace(4 * np.log(10) / fastest, 4 * np.log(10) / slowest, num_times)


def heat_kernel_signatures(spectrum: Spectrum, times: Float[np.ndarray, " p"]) -> Float[np.ndarray, "n p"]:
    """Heat kernel signatures Σ_j exp(-t λ_j) φ_j² of all points (the paper's Eq. 9), times the area.

    The printed signature is not scale invariant, since eigenfunctions normalised by area shrink as the cloud grows;
    times the area it is.
    """
    decay = np.exp(-np.outer(spectrum.eigenvalues, times))
    return spectrum.area * (spectrum.eigenfunctions**2 @ decay)


def whiten(signatures: Float[np.ndarray, "a p"], reference: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "a r"]:
    """Signatures whose Euclidean distance is the Mahalanobis distance of the reference's signatures.

    Signatures at neighbouring times are nearly the same number, and large where the surface ends in a tip: plain
    distances compare tips at large times and nothing else.
    """
    mean = reference.mean(axis=0)
    _, singular, axes = np.linalg.svd(reference - mean, full_matrices=False)
    spread = singular / np.sqrt(len(reference))
    kept = spread > NOISE_FLOOR * spread[0]
    return (signatures - mean) @ axes[kept].T / spread[kept]


def sign_vectors(spectrum: Spectrum, index: Int[np.ndarray, " a"]) -> Int[np.ndarray, "a k"]:
    """Signs of the eigenfunctions at points: +1 where φ_j ≥ 0, else -1.

    Neighbours share them; a point and its twin differ where an eigenfunction is odd under the reflection.
    """
    return np.where(spectrum.eigenfunctions[index] >= 0, 1, -1)
