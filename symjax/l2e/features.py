"""The pairs as quadratic-form features: squared residuals of many planes as one matrix product.

f_i/4 = θ(v, ω)·φ_i with θ = [vvᵀ (6), ωv (3), ω², 1] and φ_i = [mmᵀ − hhᵀ (6), −2m (3), 1, ‖h‖²], where
m_i = (x_i + y_i)/2 and h_i = (y_i − x_i)/2. The features are stored 11 × n: the transposed layout loses nearly all of
the speed. `jax.vmap` over planes turns the matrix-vector products of one plane into products of matrices.
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from symjax.l2e.objective import PairEnds, Scalar, Vector

TILE = 1024  # pairs per product: small enough that their weights at a few hundred planes stay in a core's cache
FAR = 1e6  # ‖h‖² given to pairs of weight 0: large enough that their exponent is never the largest one
NUM_LINEAR = 10  # features whose coefficients depend on the plane; the eleventh, ‖h‖², has the coefficient 1

ROWS, COLUMNS = np.array([0, 1, 2, 0, 0, 1], np.int32), np.array([0, 1, 2, 1, 2, 2], np.int32)
"""Rows and columns of the six entries of a symmetric 3 × 3 matrix, in the order of the features."""

MULTIPLICITY = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
"""How often each of these entries occurs in the matrix."""

_FIRST, _SECOND = (index.astype(np.int32) for index in np.triu_indices(NUM_LINEAR))

PRODUCT_INDEX = np.zeros((NUM_LINEAR, NUM_LINEAR), np.int32)
"""Row of `Features.products` that holds φ_a φ_b."""
PRODUCT_INDEX[_FIRST, _SECOND] = PRODUCT_INDEX[_SECOND, _FIRST] = np.arange(len(_FIRST))


class Features(NamedTuple):
    """Features of centred and scaled pairs, in tiles of at most `TILE` pairs; or of one tile, without the first axis.

    Attributes:
        phi: the 11 features φ of every pair.
        weighted: w φ.
        products: w φ_a φ_b for all a ≤ b ≤ 10. A product with these gives every moment of the L2E weights.
        midpoints: mid-points m.
        half_differences: half differences h.
        weights: weights w; 0 in padding.
        num_tiles: number of tiles that hold pairs; the tiles after them are padding.
    """

    phi: Float[Array, "*t 11 p"]
    weighted: Float[Array, "*t 11 p"]
    products: Float[Array, "*t 55 p"]
    midpoints: Float[Array, "*t 3 p"]
    half_differences: Float[Array, "*t 3 p"]
    weights: Float[Array, "*t p"]
    num_tiles: Int[Array, ""]


def coefficients(v: Vector, omega: Scalar) -> Float[Array, " 11"]:
    """Returns θ(v, ω), including the coefficient 1 of ‖h‖²."""
    square = v[ROWS] * v[COLUMNS] * MULTIPLICITY.astype(v.dtype)
    return jnp.concatenate([square, omega * v, jnp.stack([omega**2, jnp.ones_like(omega)])])


def feature_rows(x: PairEnds, y: PairEnds) -> Float[Array, "11 n"]:
    """Returns φ of every pair."""
    m, h = 0.5 * (x + y).T, 0.5 * (y - x).T
    square = h[0] ** 2 + h[1] ** 2 + h[2] ** 2
    last = jnp.stack([jnp.ones_like(square), square])
    return jnp.concatenate([m[ROWS] * m[COLUMNS] - h[ROWS] * h[COLUMNS], -2 * m, last])


def features(
    x: PairEnds, y: PairEnds, weights: Float[Array, " n"] | None = None, *, used: int | Int[Array, ""] | None = None
) -> Features:
    """Computes the features of pairs that are centred and scaled to about unit radius.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: nonnegative weights of the pairs. Pairs of weight 0 are moved so far away that they have no effect.
        used: number of leading pairs that are not padding, by default all. It may be traced. Tiles of padding cost
            nothing.
    """
    weights = jnp.ones_like(x[:, 0]) if weights is None else weights
    used = len(x) if used is None else used
    tile = min(TILE, len(x))
    extra = -len(x) % tile
    x, y, weights = (jnp.pad(a, ((0, extra), *[(0, 0)] * (a.ndim - 1))) for a in (x, y, weights))
    num_tiles = jnp.asarray(-(-used // tile))
    # tile by tile, each small enough for a core's cache
    tiles: Features = jax.lax.map(_tile, tuple(a.reshape(-1, tile, *a.shape[1:]) for a in (x, y, weights)))
    return tiles._replace(num_tiles=num_tiles)


def _tile(pairs: tuple[Float[Array, "p 3"], Float[Array, "p 3"], Float[Array, " p"]]) -> Features:
    x, y, weights = pairs
    phi = jnp.where(weights[None, :] > 0, feature_rows(x, y), 0)
    phi = phi.at[-1].set(jnp.where(weights > 0, phi[-1], FAR))
    products = weights[None, :] * phi[_FIRST] * phi[_SECOND]
    m, h = 0.5 * (x + y).T, 0.5 * (y - x).T
    return Features(phi, weights[None, :] * phi, products, m, h, weights, jnp.asarray(1))


def _exponents(pairs: Features, tile: Int[Array, ""], v: Vector, omega: Scalar, sigma: Scalar) -> Float[Array, " p"]:
    """Computes −f_i/2σ² for the pairs of a tile.

    In float32 the features lose digits to cancellation: 2 % of a weight at σ = 0.005 of the radius. Then the residuals
    are computed directly from m and h, which takes a quarter more time.
    """
    if pairs.phi.dtype == jnp.float64:
        return jnp.dot(-2 / sigma**2 * coefficients(v, omega), pairs.phi[tile], precision="highest")
    m, h = pairs.midpoints[tile], pairs.half_differences[tile]
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
    """Computes the sums Σ exp(−f_i/2σ²) row_i over all pairs, each as a common exponent and a factor.

    The largest exponent is subtracted, tile by tile (log-sum-exp), so that nothing underflows even if the plane is far
    from every pair.

    Args:
        pairs: the pairs.
        v: unit normal.
        omega: offset.
        sigma: scale σ.
        rows: returns the rows of a tile.

    Returns:
        The largest exponent, and the sums divided by its exponential.
    """
    first = rows(jnp.asarray(0))
    # finite, because −∞ − (−∞) is NaN
    empty = jnp.asarray(-0.1 * np.finfo(first.dtype).max, first.dtype), jnp.zeros_like(first[:, 0])

    def add(tile: Int[Array, ""], sums: tuple[Scalar, Float[Array, " r"]]) -> tuple[Scalar, Float[Array, " r"]]:
        exponents = _exponents(pairs, tile, v, omega, sigma)
        largest = jnp.maximum(sums[0], jnp.max(exponents))
        new = jnp.dot(rows(tile), jnp.exp(exponents - largest), precision="highest")
        return largest, jnp.exp(sums[0] - largest) * sums[1] + new

    if len(pairs.phi) == 1:
        return add(jnp.asarray(0), empty)
    total: tuple[Scalar, Float[Array, " r"]] = jax.lax.fori_loop(0, pairs.num_tiles, add, empty)
    return total
