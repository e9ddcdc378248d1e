"""Starting normals computed from all pairs, and the least-squares plane."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.jax_config import full_precision
from symjax.l2e.manifolds import normalise, tangent_projection

TRIM = 0.25  # fraction trimmed from each end of every coordinate in the robust Grassmann average


def weighted_quantile(
    values: Float[Array, " n"], probabilities: Float[Array, " k"], weights: Float[Array, " n"]
) -> Float[Array, " k"]:
    """Computes quantiles of weighted values: where the cumulative weight reaches each probability."""
    order = jnp.argsort(values)
    cumulative = jnp.cumsum(weights[order])
    index = jnp.searchsorted(cumulative, probabilities * cumulative[-1])
    return values[order][jnp.minimum(index, len(values) - 1)]


def median_point(points: Float[Array, "n 3"], weights: Float[Array, " n"]) -> Float[Array, " 3"]:
    """Computes the weighted median of every coordinate."""
    half = jnp.asarray([0.5], points.dtype)
    return jax.vmap(lambda column: weighted_quantile(column, half, weights)[0], 1)(points)


def _trimmed_mean(values: Float[Array, " n"], weights: Float[Array, " n"], trim: float) -> Float[Array, ""]:
    order = jnp.argsort(values)
    cumulative = jnp.cumsum(weights[order])
    kept = jnp.diff(jnp.clip(cumulative / cumulative[-1], trim, 1 - trim), prepend=trim)
    return jnp.sum(kept * values[order]) / (1 - 2 * trim)


@full_precision
def grassmann_average(
    u: Float[Array, "n 3"],
    *,
    weights: Float[Array, " n"] | None = None,
    trim: float = 0.0,
    max_steps: int = 100,
) -> Float[Array, " 3"]:
    """Computes the leading direction of centred vectors by the (trimmed) Grassmann average.

    Every u_i counts as a one-dimensional subspace weighted by its length. The iteration q ← mean of sign(u_i·q) u_i,
    normalised, begins at the leading principal direction and ends when q no longer changes. Trimming the mean of every
    coordinate is not rotation equivariant by itself, so it is done in the frame of the principal directions.
    Reference: Hauberg, Feragen, Black, "Grassmann averages for scalable robust PCA", CVPR 2014.

    Args:
        u: centred vectors.
        weights: nonnegative weights.
        trim: fraction trimmed from each end of every coordinate, from 0 (the plain average) to below 0.5.
        max_steps: limit on the iterations.

    Returns:
        A unit vector.
    """
    if weights is None:
        weights = jnp.ones_like(u[:, 0])
    _, frame = jnp.linalg.eigh((weights[:, None] * u).T @ u)
    rotated = u @ frame

    def mean(signed: Float[Array, "n 3"]) -> Float[Array, " 3"]:
        if trim == 0:
            return jnp.sum(weights[:, None] * signed, axis=0)
        return jax.vmap(lambda column: _trimmed_mean(column, weights, trim), 1)(signed)

    def should_continue(state: tuple[Float[Array, " 3"], Bool[Array, ""], Int[Array, ""]]) -> Bool[Array, ""]:
        return ~state[1] & (state[2] < max_steps)

    def iterate(
        state: tuple[Float[Array, " 3"], Bool[Array, ""], Int[Array, ""]],
    ) -> tuple[Float[Array, " 3"], Bool[Array, ""], Int[Array, ""]]:
        q, _, k = state
        sign = jnp.where(rotated @ q < 0, -1, 1).astype(u.dtype)
        average = mean(sign[:, None] * rotated)
        square = jnp.sum(average**2)
        new = jnp.where(square > 0, average / jnp.sqrt(jnp.where(square > 0, square, 1)), q)
        return new, jnp.all(jnp.abs(new - q) <= 4 * np.finfo(u.dtype).eps), k + 1

    leading = jnp.asarray([0.0, 0.0, 1.0], u.dtype)
    q, _, _ = jax.lax.while_loop(should_continue, iterate, (leading, jnp.asarray(False), jnp.asarray(0)))
    return normalise(frame @ q)


def _centred_midpoints(
    x: Float[Array, "n 3"], y: Float[Array, "n 3"], weights: Float[Array, " n"] | None
) -> tuple[Float[Array, "n 3"], Float[Array, " n"]]:
    if weights is None:
        weights = jnp.ones_like(x[:, 0])
    m = 0.5 * (x + y)
    return m - median_point(m, weights)[None, :], weights


def rga_normal(
    x: Float[Array, "n 3"],
    y: Float[Array, "n 3"],
    *,
    weights: Float[Array, " n"] | None = None,
    trim: float = TRIM,
) -> Float[Array, " 3"]:
    """Computes the paper's start v = η₁ × η₂, where the robust Grassmann averages η₁, η₂ span the mid-points' plane.

    The mid-points are centred on their median first. Without centring the start is tens of degrees off.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: nonnegative weights of the pairs.
        trim: see `grassmann_average`.

    Returns:
        A unit normal.
    """
    u, weights = _centred_midpoints(x, y, weights)
    eta_1 = grassmann_average(u, weights=weights, trim=trim)
    deflated = jax.vmap(lambda row: tangent_projection(eta_1, row))(u)
    eta_2 = grassmann_average(deflated, weights=weights, trim=trim)
    # removes the rounding error of eta_2 along eta_1
    return normalise(jnp.cross(eta_1, normalise(tangent_projection(eta_1, eta_2))))


@full_precision
def pca_normal(
    x: Float[Array, "n 3"], y: Float[Array, "n 3"], *, weights: Float[Array, " n"] | None = None
) -> Float[Array, " 3"]:
    """Computes the classical start, the least principal direction of the centred mid-points (paper, Sec. 3.2)."""
    u, weights = _centred_midpoints(x, y, weights)
    vectors: Float[Array, "3 3"] = jnp.linalg.eigh((weights[:, None] * u).T @ u)[1]
    return vectors[:, 0]


@full_precision
def l2_plane(
    x: Float[Array, "n 3"],
    y: Float[Array, "n 3"],
    weights: Float[Array, " n"] | None = None,
    *,
    as_printed: bool = False,
) -> Plane:
    """Computes the least-squares plane, which is the maximum-likelihood plane and not robust (Eq. 2).

    With the best offset ω = v·m̄ inserted, v is the eigenvector of the least eigenvalue of sym(Σ x_i y_iᵀ) − n m̄m̄ᵀ.
    The paper prints H = Σ x_i y_iᵀ, which is correct only if Σ m_i = 0.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: nonnegative weights of the pairs.
        as_printed: whether to use the symmetric part of the printed H instead, with the same ω = v·m̄.

    Returns:
        The plane, of canonical sign.
    """
    if weights is None:
        weights = jnp.ones_like(x[:, 0])
    mean = jnp.sum(weights[:, None] * 0.5 * (x + y), axis=0) / jnp.sum(weights)
    # centring both ends on m̄ gives the corrected H without cancellation
    shift = jnp.zeros_like(mean) if as_printed else mean
    H = (weights[:, None] * (x - shift[None, :])).T @ (y - shift[None, :])
    v = jnp.linalg.eigh(0.5 * (H + H.T))[1][:, 0]
    return Plane(v, jnp.sum(v * mean)).canonical()


def l2_normal(
    x: Float[Array, "n 3"], y: Float[Array, "n 3"], *, weights: Float[Array, " n"] | None = None
) -> Float[Array, " 3"]:
    """Returns the normal of the `l2_plane`, as a start."""
    return jnp.asarray(l2_plane(x, y, weights).normal)


NORMALS: dict[str, Callable[..., Float[Array, " 3"]]] = {"rga": rga_normal, "pca": pca_normal, "l2": l2_normal}
"""The starts that consist of one normal computed from all pairs, by name."""
