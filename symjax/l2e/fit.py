"""The result of the estimator: a fitted plane, or a batch of them, computed from minima on normalised pairs."""

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

SIGMA_TOO_LARGE = "Note: sigma exceeds the scale of the residual, so inlier_fraction is clipped to 1."

WEIGHT_TO_INLIER_FRACTION = 2**1.5
"""Ratio of ρ̂ to the mean weight: inliers have the mean weight E exp(−‖r‖²/2σ²) = 2^{−3/2}, outliers nearly 0."""


class Fit(NamedTuple):
    """A fitted plane and how it was found, or a batch of fits in leading axes.

    The arrays are JAX arrays, with one exception: float64 fits are NumPy arrays if JAX's x64 flag is off, because JAX
    would cut them to float32 in the next operation.

    Attributes:
        plane: the plane, of canonical sign, in the units of the points.
        loss: loss of the plane, in the units of the points to the power −3: `l2e_loss`, or the criterion of
            `sigma="auto"` if σ was estimated.
        status: how the solver ended, as the number of a `symjax.l2e.status.Status`.
        num_steps: steps of the solver. For the alternating solver and optimistix minimisers, rounds.
        grad_norm: norm of the Riemannian gradient of ψ (`scaled_log_loss`) with the points scaled to unit radius. The
            solver converges when it is at most `tol`.
        sigma: scale σ of the residual, given or estimated, in the units of the points.
        inlier_fraction: ρ̂ = 2^{3/2} mean exp(−f_i/2σ²), clipped to 1. It estimates the fraction of inliers if σ is
            the scale of their residual, and exceeds it if σ is larger.
        sigma_estimated: whether σ was estimated.
        start: the plane that the solver began with, of canonical sign. None for a continuation, which starts from
            other fits.

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.4)
        >>> fit = symjax.fit_plane(pairs.x, pairs.y, 0.01)
        >>> print(fit.plane.normal.round(2), f"{fit.plane.offset:.2f}", f"{fit.inlier_fraction:.2f}")
        [-0.33 -0.27  0.9 ] 0.99 0.63
        >>> fit.message
        'Converged: the Riemannian gradient is within tol.'
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
        """Whether the gradient is within tol and at least one pair supports the plane."""
        return self.status == Status.SUCCESSFUL.value

    @property
    def message(self) -> str | np.ndarray:
        """How the solver ended, in sentences; for a batch, an array of strings. It cannot be read under a trace."""
        too_large = (np.asarray(self.inlier_fraction) >= 1) & ~np.asarray(self.sigma_estimated)
        notes = np.where(too_large, f" {SIGMA_TOO_LARGE}", "")
        texts = np.char.add(sentences(np.asarray(self.status)), notes)
        return str(texts) if texts.ndim == 0 else texts

    def to_xarray(self) -> "xarray.Dataset":
        """Converts the fits of a sweep to a labelled dataset with dimensions sigma and restart.

        Fits of `sweep_clouds` have the dimension cloud before these. Requires xarray, which the extra `sweep` of
        symjax installs.

        Returns:
            The dataset. Its variables are described in `symjax.l2e.xarray_export.dataset`.

        Raises:
            InvalidArgumentError: if the fits do not come from a sweep, or if xarray is not installed.
        """
        from symjax.l2e.xarray_export import dataset

        return dataset(self)


def best(fits: Fit) -> Fit:
    """Selects the fit of lowest loss along the last axis, among the fits that converged.

    If none of them converged, selects the lowest loss of all; its status says why it did not converge.

    Args:
        fits: fits with leading axes (..., R), such as (S, R) from a `sweep`.

    Returns:
        The selected fits, with leading axes (...).

    Example:
        >>> import numpy as np, symjax
        >>> from symjax.datasets.planted_pairs import planted_pairs
        >>> pairs = planted_pairs(np.random.default_rng(0), 100, outliers=0.4)
        >>> fits = symjax.sweep(pairs.x, pairs.y, [0.01, 0.1], "fibonacci", restarts=16)
        >>> fits.loss.shape
        (2, 16)
        >>> print(pairs.normal.round(2), symjax.best(fits).plane.normal.round(2))
        [-0.33 -0.27  0.91] [[-0.33 -0.27  0.9 ]
         [-0.33 -0.27  0.9 ]]
    """
    # NumPy's float64 fits stay in NumPy
    xp: Any = fits.loss.__array_namespace__()
    loss = xp.where(xp.isnan(fits.loss), xp.inf, fits.loss)
    candidate = fits.converged | ~xp.any(fits.converged, axis=-1, keepdims=True)
    index = xp.argmin(xp.where(candidate, loss, xp.inf), axis=-1)
    axis = fits.loss.ndim - 1

    def pick(leaf: AnyArray) -> AnyArray:
        where = index.reshape(*index.shape, *[1] * (leaf.ndim - axis))
        picked: AnyArray = xp.squeeze(xp.take_along_axis(leaf, where, axis=axis), axis=axis)
        return picked

    selected: Fit = jax.tree.map(pick, fits)
    return selected


Theta = tuple[Float[Array, "n 3"], Float[Array, "n 3"], Float[Array, " n"], Float[Array, ""]]


def psi(z: Float[Array, " 4"], theta: Theta) -> Float[Array, ""]:
    """Computes `scaled_log_loss` as a function of the plane and of all quantities that a fit is differentiable in.

    In float64 it uses one matrix product, in plain JAX, which is many times faster under `vmap` than the direct
    residuals. float32 needs the direct residuals for its precision.

    Args:
        z: the plane (v, ω).
        theta: x, y, weights and σ.
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
    """Converts a plane (v, ω) of the normalised pairs to the units of the points, with canonical sign."""
    return pairs.to_given.plane(Plane(point[:3], point[3])).canonical()


def unscale(pairs: NormalisedPairs, sigma: Float[Array, ""], minimum: Minimum, start: Float[Array, " 4"] | None) -> Fit:
    """Converts a minimum at a given scale to a fit in the units of the points, differentiable in the pairs and in σ.

    Args:
        pairs: the normalised pairs.
        sigma: scale σ in their units.
        minimum: the solver's result.
        start: the plane that the solver began with, if any.
    """
    x, y, weights, to_given = pairs
    z, value = implicit_minimum(psi, SPHERE_LINE, minimum.point, minimum.value, (x, y, weights, sigma))
    log_mean_weight = 1 - value / sigma**2
    mean_weight = jnp.exp(log_mean_weight)
    loss = (4 * math.pi * sigma**2) ** -1.5 - 2 * mean_weight / (2 * math.pi * sigma**2) ** 1.5
    # if the sum of the weights underflows, so does each of them; the converse holds up to a factor of their number
    tiny = jnp.log(np.finfo(x.dtype).tiny)
    flat = log_mean_weight + jnp.log(jnp.sum(weights)) < tiny
    return Fit(
        plane=unscale_plane(z, pairs),
        loss=loss / to_given.scale**3,
        status=jnp.where(flat, jnp.int32(Status.FLAT), minimum.status),
        num_steps=minimum.num_steps,
        grad_norm=minimum.grad_norm,
        sigma=sigma * to_given.scale,
        inlier_fraction=jnp.minimum(WEIGHT_TO_INLIER_FRACTION * mean_weight, 1),
        sigma_estimated=jnp.asarray(False),
        start=None if start is None else unscale_plane(start, pairs),
    )
