"""How a solve ended, as a sentence."""

from typing import TYPE_CHECKING, Any

import equinox as eqx
import jax
import numpy as np

if TYPE_CHECKING:
    Enumeration: Any = object
else:
    Enumeration = eqx.Enumeration


class RESULTS(Enumeration):
    """The ways a solve can end. Members go through jit, vmap and while loops; `sentence` reads them."""

    successful: Any = "Converged: the Riemannian gradient is within tol."
    max_steps_reached: Any = (
        "Not converged: max_steps was reached with the gradient above tol. Raise max_steps, or start nearer (v0)."
    )
    stalled: Any = (
        "Not converged: no lower loss was found with the gradient above tol. "
        "The tolerance may be below the rounding of the points in their precision: raise tol or use float64."
    )
    flat: Any = (
        "Not converged: at the answer every pair's weight exp(-f/2 sigma^2) underflows to exactly zero, so "
        "no pair supports the plane. Raise sigma, or start elsewhere (v0)."
    )
    nonfinite: Any = "Not converged: the loss or its gradient is NaN or infinite. Check the pairs and sigma."
    unsupported: Any = (
        "Not enough mirror pairs: with sigma estimated, fewer than 20 pairs support the plane, and so few agree with "
        "some plane by chance. Give sigma, or more pairs."
    )


_MEMBERS: list[Any] = [
    RESULTS.successful,
    RESULTS.max_steps_reached,
    RESULTS.stalled,
    RESULTS.flat,
    RESULTS.nonfinite,
    RESULTS.unsupported,
]
_LOOKUP: Any = RESULTS
_SENTENCES = np.asarray([_LOOKUP[member] for member in _MEMBERS])


def sentence(result: RESULTS) -> str | np.ndarray:
    """The sentence of a result; of a batch of results, an array of sentences."""
    codes = np.asarray(jax.tree.leaves(result)[0])
    return str(_SENTENCES[codes]) if codes.ndim == 0 else _SENTENCES[codes]
