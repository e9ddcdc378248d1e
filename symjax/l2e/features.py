"""The pairs as quadratic-form features: squared residuals of many planes as one matrix product.

f_i/4 = θ(v, ω)·φ_i with θ = [vvᵀ (6), ωv (3), ω², 1] and φ_i = [mmᵀ − hhᵀ (6), −2m (3), 1, ‖h‖²], where
m_i = (x_i + y_i)/2 and h_i = (y_i − x_i)/2. Stored 11 × n: in the transposed layout nearly all of the speed is lost.
Under `jax.vmap` over planes the products of one plane become products of matrices.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from symjax.l2e.objective import PairEnds, Scalar, Vector

TILE = 1024  # pairs of one product: the weights of a few hundred planes on them stay in a core's cache
FAR = 1e6  # ‖h‖² of a pair of weight 0: far enough that its exponent is not the largest, which is taken out
NUM_LINEAR = 10  # features that carry the plane; the eleventh, ‖h‖², has the coefficient 1

ROWS, COLUMNS = np.array([0, 1, 2, 0, 0, 1], np.int32), np.array([0, 1, 2, 1, 2, 2], np.int32)
"""Order of the entries of a symmetric 3 × 3 matrix in a feature."""

TWICE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""How often each entry counts in the matrix."""

_FIRST, _SECOND = (index.astype(np.int32) for index in np.triu_indices(NUM_LINEAR))

PRODUCT_INDEX = np.zeros((NUM_LINEAR, NUM_LINEAR), np.int32)
"""Where φ_a φ_b is found among the rows of `Features.products`."""
PRODUCT_INDEX[_FIRST, _SECOND] = PRODUCT_INDEX[_SECOND, _FIRST] = np.arange(len(_FIRST))


class Features(NamedTuple):
    """Features of centred and scaled pairs, in tiles.

    Attributes:
        phi: the features φ, 11 to a pair.
        weighted: w φ.
        products: w φ_a φ_b for all a ≤ b ≤ 10: every moment of the L2E weights is a product with these.
        midpoints: m.
        halves: h.
        weights: w; 0 in padding.
        num_tiles: how many tiles hold pairs; those after them are padding.
    """

    phi: Float[Array, "t 11 p"]
    weighted: Float[Array, "t 11 p"]
    products: Float[Array, "t 55 p"]
    midpoints: Float[Array, "t 3 p"]
    halves: Float[Array, "t 3 p"]
    weights: Float[Array, "t p"]
    num_tiles: Int[Array, ""]


def coefficients(v: Vector, omega: Scalar) -> Float[Array, " 11"]:
    """θ(v, ω), with the 1 of ‖h‖²."""
    square = v[ROWS] * v[COLUMNS] * TWICE.astype(v.dtype)
    return jnp.concatenate([square, omega * v, jnp.stack([omega**2, jnp.ones_like(omega)])])


def feature_rows(x: PairEnds, y: PairEnds) -> Float[Array, "11 n"]:
    """φ of every pair."""
    m, h = 0.5 * (x + y).T, 0.5 * (y - x).T
    square = h[0] ** 2 + h[1] ** 2 + h[2] ** 2
    last = jnp.stack([jnp.ones_like(square), square])
    return jnp.concatenate([m[ROWS] * m[COLUMNS] - h[ROWS] * h[COLUMNS], -2 * m, last])


def features(
    x: PairEnds, y: PairEnds, weights: Float[Array, " n"] | None = None, *, used: int | Int[Array, ""] | None = None
) -> Features:
    """Features of pairs that are centred and scaled to about unit radius.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: nonnegative weights of the pairs. Those of weight 0 are put so far off that they count nothing.
        used: how many pairs are no padding; None is all of them. It may be traced: tiles of padding cost nothing.
    """
    weights = jnp.ones_like(x[:, 0]) if weights is None else weights
    used = len(x) if used is None else used
    tile = min(TILE, len(x))
    extra = -len(x) % tile
    x, y, weights = (jnp.pad(a, ((0, extra), *[(0, 0)] * (a.ndim - 1))) for a in (x, y, weights))
    num_tiles = jnp.asarray(-(-used // tile))
    # tile by tile, each small enough for a core's cache
    tiles = jax.lax.map(_tile, tuple(a.reshape(-1, tile, *a.shape[1:]) for a in (x, y, weights)))
    return tiles._replace(num_tiles=num_tiles)


def _tile(pairs: tuple[Float[Array, "p 3"], Float[Array, "p 3"], Float[Array, " p"]]) -> Features:
    x, y, weights = pairs
    phi = jnp.where(weights[None, :] > 0, feature_rows(x, y), 0)
    phi = phi.at[-1].set(jnp.where(weights > 0, phi[-1], FAR))
    products = weights[None, :] * phi[_FIRST] * phi[_SECOND]
    m, h = 0.5 * (x + y).T, 0.5 * (y - x).T
    return Features(phi, weights[None, :] * phi, products, m, h, weights, jnp.asarray(1))


def _exponents(pairs: Features, tile: Int[Array, ""], v: Vector, omega: Scalar, sigma: Scalar) -> Float[Array, " p"]:
    """−f_i/2σ² of the pairs of a tile.

    In float32 the features lose digits to cancellation, 2 % of a weight at σ = 0.005 of the radius: the residuals
    are then taken as they are written, at a quarter more time.
    """
    if pairs.phi.dtype == jnp.float64:
        return jnp.dot(-2 / sigma**2 * coefficients(v, omega), pairs.phi[tile], precision="highest")
    m, h = pairs.midpoints[tile], pairs.halves[tile]
    along = h[0] * v[0] + h[1] * v[1] + h[2] * v[2]
    height = m[0] * v[0] + m[1] * v[1] + m[2] * v[2] - omega
    across = [h[k] - along * v[k] for k in range(3)]
    quarter = height**2 + across[0] ** 2 + across[1] ** 2 + across[2] ** 2
    return -2 / sigma**2 * jnp.where(pairs.weights[tile] > 0, quarter, FAR)


def weighted_sums(
    pairs: Features,
    v: Vector,
    omega: Scalar,
    sigma: Scalar,
    rows: Callable[[Int[Array, ""]], Float[Array, "r p"]],
) -> tuple[Scalar, Float[Array, " r"]]:
    """Sums Σ exp(−f_i/2σ²) row_i over all pairs, as a common logarithm and what it multiplies.

    The largest exponent is taken out, tile by tile, so that nothing underflows however far the plane is from every
    pair.

    Args:
        pairs: the pairs.
        v: unit normal.
        omega: offset.
        sigma: scale σ.
        rows: gives the rows of a tile.

    Returns:
        The largest exponent, and the sums divided by its exponential.
    """
    first = rows(jnp.asarray(0))
    # not minus infinity, whose difference from itself is no number
    nothing = jnp.asarray(-0.1 * jnp.finfo(first.dtype).max, first.dtype), jnp.zeros_like(first[:, 0])

    def add(tile: Int[Array, ""], sums: tuple[Scalar, Float[Array, " r"]]) -> tuple[Scalar, Float[Array, " r"]]:
        exponents = _exponents(pairs, tile, v, omega, sigma)
        largest = jnp.maximum(sums[0], jnp.max(exponents))
        new = jnp.dot(rows(tile), jnp.exp(exponents - largest), precision="highest")
        return largest, jnp.exp(sums[0] - largest) * sums[1] + new

    if len(pairs.phi) == 1:
        return add(jnp.asarray(0), nothing)
    return jax.lax.fori_loop(0, pairs.num_tiles, add, nothing)
