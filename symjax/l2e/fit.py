"""A fitted plane, or a batch of them; from a minimum on normalised pairs, with its derivatives."""

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.arrays import AnyArray
from symjax.geometry.plane import Plane
from symjax.l2e.features import coefficients, feature_rows
from symjax.l2e.implicit import implicit_minimum
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.objective import scaled_log_loss
from symjax.l2e.pairs.normalised import NormalisedPairs
from symjax.l2e.solvers.base import Minimum
from symjax.l2e.status import Status, sentences

if TYPE_CHECKING:
    import xarray

SIGMA_TOO_LARGE = "Note: sigma exceeds the scale of the pairs' residual; the share of mirror pairs is cut to 1."

FRACTION = 2**1.5
"""ρ̂ over the mean weight: that of an inlier is E exp(−‖r‖²/2σ²) = 2^{−3/2}, that of an outlier almost 0."""


class Fit(NamedTuple):
    """The fitted plane and how the fit went; leading axes are those of the fits.

    The arrays are of JAX, but for float64 answers where JAX's x64 flag is off: those are of NumPy, since JAX would cut
    them to float32 in the next operation.

    Attributes:
        plane: the plane, of canonical sign, in the units of the points.
        loss: the criterion at the plane: `l2e_loss`, or where σ was estimated that of `sigma="auto"`; length⁻³.
        status: how the solve ended, the number of a member of `symjax.l2e.status.Status`.
        num_steps: steps of the solver, or rounds of the alternating one and of an optimistix minimiser.
        grad_norm: norm of the Riemannian gradient of ψ (`scaled_log_loss`), the points scaled to unit radius:
            what `tol` bounds.
        sigma: scale σ of the residual, given or estimated, in the units of the points.
        inlier_fraction: ρ̂ = 2^{3/2} mean exp(−f_i/2σ²), the share of mirror pairs if σ is their residual's scale;
            where σ exceeds that scale, at most 1.
        sigma_estimated: whether σ was estimated.
        start: the plane that the solver began with, of canonical sign; None of a continuation, which follows others.
    """

    plane: Plane
    loss: Float[AnyArray, "*batch"]
    status: Int[AnyArray, "*batch"]
    num_steps: Int[AnyArray, "*batch"]
    grad_norm: Float[AnyArray, "*batch"]
    sigma: Float[AnyArray, "*batch"]
    inlier_fraction: Float[AnyArray, "*batch"]
    sigma_estimated: Bool[AnyArray, "*batch"]
    start: Plane | None

    @property
    def converged(self) -> Bool[AnyArray, "*batch"]:
        """Whether the gradient is within tol and some pair supports the plane."""
        return self.status == Status.SUCCESSFUL.value

    @property
    def message(self) -> str | np.ndarray:
        """How the solve ended, in sentences; of a batch, an array of such texts. Not under a trace."""
        too_large = (np.asarray(self.inlier_fraction) >= 1) & ~np.asarray(self.sigma_estimated)
        notes = np.where(too_large, f" {SIGMA_TOO_LARGE}", "")
        texts = np.char.add(sentences(np.asarray(self.status)), notes)
        return str(texts) if texts.ndim == 0 else texts

    def to_xarray(self) -> "xarray.Dataset":
        """The fits of a sweep as a labelled dataset: dimensions cloud (of `sweep_clouds`), sigma and restart.

        Needs xarray: `pip install "symjax[sweep]"` from the source tree, or xarray itself.

        Raises:
            InvalidArgumentError: the fits are not those of a sweep.
        """
        from symjax.l2e.xarray_export import dataset

        return dataset(self)


def best(fits: Fit) -> Fit:
    """Of each row of fits, the one of lowest loss among those that converged.

    Where none of a row converged, the one of lowest loss, with its own status.

    Args:
        fits: fits with axes (..., R), such as the (S, R) of a `sweep`.

    Returns:
        The fits without their last axis.
    """
    # NumPy's float64 fits stay in NumPy
    xp: Any = fits.loss.__array_namespace__()
    loss = xp.where(xp.isnan(fits.loss), xp.inf, fits.loss)
    candidate = fits.converged | ~xp.any(fits.converged, axis=-1, keepdims=True)
    # at equal losses the converged comes first, also where every loss is infinite
    index = xp.argmin(xp.where(candidate, loss, xp.inf), axis=-1)
    axis = fits.loss.ndim - 1

    def pick(leaf: AnyArray) -> AnyArray:
        where = index.reshape(*index.shape, *[1] * (leaf.ndim - axis))
        return xp.squeeze(xp.take_along_axis(leaf, where, axis=axis), axis=axis)

    return jax.tree.map(pick, fits)


def psi(z: Float[Array, " 4"], theta: tuple[Array, Array, Array, Array]) -> Float[Array, ""]:
    """`scaled_log_loss` as a function of the plane and of everything that an answer has a derivative in.

    In float64 by one matrix product, plain JAX: many times faster under `vmap` than the residuals as written, which
    float32 needs for its digits.
    """
    x, y, weights, sigma = theta
    if x.dtype != jnp.float64:
        return scaled_log_loss(z[:3], z[3], sigma, x, y, weights=weights)
    exponents = jnp.dot(-2 / sigma**2 * coefficients(z[:3], z[3]), feature_rows(x, y), precision="highest")
    exponents = jnp.where(weights > 0, exponents, -jnp.inf)
    largest = jax.lax.stop_gradient(jnp.max(exponents))
    kernel = jnp.dot(jnp.exp(exponents - largest), weights, precision="highest")
    return sigma**2 * (1 + jnp.log(jnp.sum(weights)) - largest - jnp.log(kernel))


def unscale_plane(point: Float[Array, " d"], pairs: NormalisedPairs) -> Plane:
    """A plane (v, ω) of the normalised pairs as one in the units of the points, of canonical sign."""
    return pairs.to_given.plane(Plane(point[:3], point[3])).canonical()


def unscale(pairs: NormalisedPairs, sigma: Float[Array, ""], minimum: Minimum, start: Float[Array, " 4"] | None) -> Fit:
    """The fit at a given scale, differentiable in the pairs and in σ.

    Args:
        pairs: the normalised pairs.
        sigma: scale σ in their units.
        minimum: what the solver found.
        start: the plane that it began with, where there is one.
    """
    x, y, weights, to_given = pairs
    z, value = implicit_minimum(psi, SPHERE_LINE, minimum.point, minimum.value, (x, y, weights, sigma))
    log_share = 1 - value / sigma**2
    share = jnp.exp(log_share)
    loss = (4 * math.pi * sigma**2) ** -1.5 - 2 * share / (2 * math.pi * sigma**2) ** 1.5
    # all weights underflow where their sum does, but for a factor that is at most their number
    tiny = jnp.log(jnp.finfo(x.dtype).tiny)
    flat = log_share + jnp.log(jnp.sum(weights)) < tiny
    return Fit(
        plane=unscale_plane(z, pairs),
        loss=loss / to_given.scale**3,
        status=jnp.where(flat, jnp.int32(Status.FLAT), minimum.status),
        num_steps=minimum.num_steps,
        grad_norm=minimum.grad_norm,
        sigma=sigma * to_given.scale,
        inlier_fraction=jnp.minimum(FRACTION * share, 1),
        sigma_estimated=jnp.asarray(False),
        start=None if start is None else unscale_plane(start, pairs),
    )
