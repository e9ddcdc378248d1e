"""Pairs as they are given: checked, and padded so that few sizes are compiled."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from symjax.l2e.pairs.arguments import Points, Weights, checked_pairs, checked_weights

LEAST_SIZE = 256
"""Pairs are padded to this or the next power of two."""


class PaddedPairs(NamedTuple):
    """Pairs, padded.

    Attributes:
        x: one end of every pair, in the units of the points.
        y: the other end.
        weights: of the pairs; 0 in padding.
        used: how many pairs are no padding.
    """

    x: Float[Array, "b 3"]
    y: Float[Array, "b 3"]
    weights: Float[Array, " b"]
    used: Int[Array, ""]


def padded_size(num: int, least: int = LEAST_SIZE) -> int:
    """The size that `num` pairs are padded to, a power of two or the least."""
    return max(least, 1 << (num - 1).bit_length())


def pad_pairs(x: Points, y: Points, weights: Weights | None) -> PaddedPairs:
    """Checks pairs and pads them.

    What lies on the host is padded in NumPy, and stays there until a compiled function takes it: JAX would compile the
    padding of every size. What lies on a device stays on it.

    Raises:
        SymjaxError: see `symjax.l2e.pairs.arguments`.
    """
    x, y = checked_pairs(x, y)
    w = checked_weights(weights, len(x), x.dtype)
    extra = padded_size(len(x)) - len(x)

    def padded(array: Any) -> Any:
        widths = ((0, extra), *[(0, 0)] * (array.ndim - 1))
        return jnp.pad(array, widths) if isinstance(array, jax.Array) else np.pad(array, widths)

    used: Any = np.asarray(len(x))
    return PaddedPairs(padded(x), padded(y), padded(w), used)
