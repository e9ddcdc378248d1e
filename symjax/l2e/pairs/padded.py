"""Pairs in the units of the points, checked and padded so that JAX compiles for few sizes."""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from symjax.geometry.arrays import JitInput
from symjax.l2e.pairs.arguments import Points, Weights, checked_pairs, checked_weights

LEAST_SIZE = 256
"""Smallest size that pairs are padded to; larger sets are padded to the next power of two."""


class PaddedPairs(NamedTuple):
    """Pairs followed by padding.

    Attributes:
        x: one end of every pair, in the units of the points.
        y: the other end.
        weights: weights of the pairs; 0 in padding.
        used: number of pairs without padding.
    """

    x: Float[JitInput, "b 3"]
    y: Float[JitInput, "b 3"]
    weights: Float[JitInput, " b"]
    used: Int[JitInput, ""]


def padded_size(num: int, least: int = LEAST_SIZE) -> int:
    """Returns the size that `num` pairs are padded to: the next power of two, and at least `least`."""
    return max(least, 1 << (num - 1).bit_length())


def pad_pairs(x: Points, y: Points, weights: Weights | None) -> PaddedPairs:
    """Checks pairs and weights, and pads them.

    Arrays on the host are padded by NumPy, because JAX would compile the padding for every size. They stay on the host
    until a compiled function takes them. Arrays on a device stay on the device.

    Raises:
        SymjaxError: if an argument is invalid, see `symjax.l2e.pairs.arguments`.
    """
    x, y = checked_pairs(x, y)
    w = checked_weights(weights, len(x), x.dtype)
    extra = padded_size(len(x)) - len(x)

    def padded(array: Any) -> Any:
        widths = ((0, extra), *[(0, 0)] * (array.ndim - 1))
        return jnp.pad(array, widths) if isinstance(array, jax.Array) else np.pad(array, widths)

    used: Any = np.asarray(len(x))
    return PaddedPairs(padded(x), padded(y), padded(w), used)
