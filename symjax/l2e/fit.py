"""A fitted plane, or a batch of them."""

from typing import TYPE_CHECKING, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.status import Status, sentences

if TYPE_CHECKING:
    import xarray


class Fit(NamedTuple):
    """The fitted plane and how the fit went; leading axes are those of the fits.

    Attributes:
        plane: the plane, of canonical sign, in the units of the points.
        loss: the criterion at the plane: `l2e_loss`, or where σ was estimated that of `sigma="auto"`; length⁻³.
        status: how the solve ended, the number of a member of `symjax.l2e.status.Status`.
        num_steps: steps of the solver, or rounds of the alternating one.
        grad_norm: norm of the Riemannian gradient of ψ (`scaled_log_loss`), the points scaled to unit radius:
            what `tol` bounds.
        sigma: scale σ of the residual, given or estimated, in the units of the points.
        inlier_fraction: ρ̂ = 2^{3/2} mean exp(−f_i/2σ²), the share of mirror pairs if σ is their residual's scale.
        sigma_estimated: whether σ was estimated.
    """

    plane: Plane
    loss: Float[Array, "*batch"]
    status: Int[Array, "*batch"]
    num_steps: Int[Array, "*batch"]
    grad_norm: Float[Array, "*batch"]
    sigma: Float[Array, "*batch"]
    inlier_fraction: Float[Array, "*batch"]
    sigma_estimated: Bool[Array, "*batch"]

    @property
    def converged(self) -> Bool[Array, "*batch"]:
        """Whether the gradient is within tol and some pair supports the plane."""
        return self.status == Status.SUCCESSFUL.value

    @property
    def message(self) -> str | np.ndarray:
        """How the solve ended, a sentence; of a batch, an array of sentences. Not under a trace."""
        return sentences(np.asarray(self.status))

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
    loss = jnp.where(jnp.isnan(fits.loss), jnp.inf, fits.loss)
    candidate = fits.converged | ~jnp.any(fits.converged, axis=-1, keepdims=True)
    # at equal losses the converged comes first, also where every loss is infinite
    index = jnp.argmin(jnp.where(candidate, loss, jnp.inf), axis=-1)
    axis = fits.loss.ndim - 1

    def pick(leaf: Array) -> Array:
        where = index.reshape(*index.shape, *[1] * (leaf.ndim - axis))
        return jnp.squeeze(jnp.take_along_axis(leaf, where, axis=axis), axis=axis)

    return jax.tree.map(pick, fits)
