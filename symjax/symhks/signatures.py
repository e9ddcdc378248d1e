"""Heat kernel signatures, which are equal at mirror images, and eigenfunction signs, which may differ there."""

from typing import Literal, get_args

import numpy as np
from jaxtyping import Float, Int

from symjax.errors import InvalidArgumentError
from symjax.geometry.checks import choice, whole
from symjax.symhks.spectrum import ZERO_EIGENVALUE, Spectrum

NUM_TIMES = 32
"""Number of diffusion times p (not given in the paper): enough to distinguish the squares of 20 eigenfunctions."""

NOISE_FLOOR = 1e-3
"""Principal directions with a standard deviation below this fraction of the largest carry only sampling noise."""

TimeScale = Literal["logarithmic", "uniform"]


def diffusion_times(
    spectrum: Spectrum, *, num_times: int = NUM_TIMES, scale: TimeScale = "logarithmic"
) -> Float[np.ndarray, " p"]:
    """Returns diffusion times that span the spectrum.

    λ_2 is the smallest eigenvalue above rounding. A cloud of two connected components has two zero eigenvalues, with
    which the range of the paper would be infinite.

    Args:
        spectrum: eigenvalues of the cloud.
        num_times: number of times p.
        scale: `"uniform"` (the paper), evenly spaced in [10 ln 10/λ_k, 10 ln 10/λ_2]; or `"logarithmic"`, evenly spaced
            logarithms in [4 ln 10/λ_k, 4 ln 10/λ_2], by Sun et al., "A Concise and Provably Informative Multi-Scale
            Signature Based on Heat Diffusion" (SGP 2009).

    Returns:
        The times, in squared units of the points, ascending.

    Raises:
        InvalidArgumentError: if the scale is unknown, or no eigenvalue is positive.
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
    """Computes the heat kernel signatures Σ_j exp(−t λ_j) φ_j² of all points (paper, Eq. 9), times the area.

    The factor makes them scale invariant, which the paper's signatures are not: eigenfunctions normalised by area
    decrease as the cloud grows.
    """
    decay = np.exp(-np.outer(spectrum.eigenvalues, times))
    return spectrum.area * (spectrum.eigenfunctions**2 @ decay)


def whiten(signatures: Float[np.ndarray, "a p"], reference: Float[np.ndarray, "n p"]) -> Float[np.ndarray, "a r"]:
    """Whitens signatures: their Euclidean distance becomes the Mahalanobis distance of the reference signatures.

    Signatures at neighbouring times are almost equal, and they are large where the surface ends in a tip. Without
    whitening, distances would depend on the tips at large times and on little else.
    """
    mean = reference.mean(axis=0)
    _, singular, axes = np.linalg.svd(reference - mean, full_matrices=False)
    spread = singular / np.sqrt(len(reference))
    kept = spread > NOISE_FLOOR * spread[0]
    whitened: Float[np.ndarray, "a r"] = (signatures - mean) @ axes[kept].T / spread[kept]
    return whitened


def sign_vectors(spectrum: Spectrum, index: Int[np.ndarray, " a"]) -> Int[np.ndarray, "a k"]:
    """Returns the signs of the eigenfunctions at points: +1 where φ_j ≥ 0, else −1.

    They are equal at neighbours, and opposite at mirror images if the eigenfunction is odd under the reflection.
    """
    return np.where(spectrum.eigenfunctions[index] >= 0, 1, -1)
