"""Pairs as they are given: checked, and padded so that few sizes are compiled."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, ArrayLike, Float, Int

from symjax.l2e.pairs.arguments import checked_pairs, checked_weights

LEAST_BUCKET = 256
"""Pairs are padded to this or the next power of two."""


class Pairs(NamedTuple):
    """Pairs, padded.

    Attributes:
        x: one end of every pair, in the units of the points.
        y: the other end.
        weights: of the pairs; 0 in padding.
        used: how many pairs are no padding.
    """

    x: Float[Array, "b 3"]
    y: Float[Array, "b 3"]
    weights: Float[Array, "b"]
    used: Int[Array, ""]


def bucket(num: int) -> int:
    """The size that so many pairs are padded to."""
    return max(LEAST_BUCKET, 1 << (num - 1).bit_length())


def given_pairs(x: ArrayLike, y: ArrayLike, weights: ArrayLike | None) -> Pairs:
    """Checks pairs and pads them.

    What is known is padded in NumPy, and stays there until a compiled function takes it: JAX would compile the padding
    of every size.

    Raises:
        SymjaxError: see `symjax.l2e.pairs.arguments`.
    """
    x, y = checked_pairs(x, y)
    w = checked_weights(weights, len(x), x.dtype)
    extra = bucket(len(x)) - len(x)

    def padded(array: Any) -> Any:
        widths = ((0, extra), *[(0, 0)] * (array.ndim - 1))
        return jnp.pad(array, widths) if isinstance(array, jax.core.Tracer) else np.pad(array, widths)

    used: Any = np.asarray(len(x))
    return Pairs(padded(x), padded(y), padded(w), used)
