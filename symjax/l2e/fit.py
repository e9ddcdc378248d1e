"""A fitted plane, or a batch of them."""

from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.status import Status, sentences

if TYPE_CHECKING:
    import xarray

SIGMA_TOO_LARGE = "Note: sigma exceeds the scale of the pairs' residual; the share of mirror pairs is cut to 1."


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
    loss: Float[Array, "*batch"]
    status: Int[Array, "*batch"]
    num_steps: Int[Array, "*batch"]
    grad_norm: Float[Array, "*batch"]
    sigma: Float[Array, "*batch"]
    inlier_fraction: Float[Array, "*batch"]
    sigma_estimated: Bool[Array, "*batch"]
    start: Plane | None

    @property
    def converged(self) -> Bool[Array, "*batch"]:
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

    def pick(leaf: Array) -> Array:
        where = index.reshape(*index.shape, *[1] * (leaf.ndim - axis))
        return xp.squeeze(xp.take_along_axis(leaf, where, axis=axis), axis=axis)

    return jax.tree.map(pick, fits)
