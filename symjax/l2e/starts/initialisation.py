"""Starts for the solver, and the least-squares baseline."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.plane import Plane
from symjax.l2e.manifolds import normalise, tangent_projection

TRIM = 0.25  # share cut from each end of every coordinate in the trimmed Grassmann average


def weighted_quantile(
    values: Float[Array, " n"], shares: Float[Array, " k"], weights: Float[Array, " n"]
) -> Float[Array, " k"]:
    """Quantiles of weighted values: the values at which the cumulative weight passes each share."""
    order = jnp.argsort(values)
    mass = jnp.cumsum(weights[order])
    index = jnp.searchsorted(mass, shares * mass[-1])
    return values[order][jnp.minimum(index, len(values) - 1)]


def median_point(points: Float[Array, "n 3"], weights: Float[Array, " n"]) -> Float[Array, " 3"]:
    """The coordinatewise weighted median."""
    half = jnp.asarray([0.5], points.dtype)
    return jax.vmap(lambda column: weighted_quantile(column, half, weights)[0], 1)(points)


def _trimmed_mean(values: Float[Array, " n"], weights: Float[Array, " n"], trim: float) -> Float[Array, ""]:
    order = jnp.argsort(values)
    mass = jnp.cumsum(weights[order])
    kept = jnp.diff(jnp.clip(mass / mass[-1], trim, 1 - trim), prepend=trim)
    return jnp.sum(kept * values[order]) / (1 - 2 * trim)


@jax.default_matmul_precision("highest")
def grassmann_average(
    u: Float[Array, "n 3"],
    *,
    weights: Float[Array, " n"] | None = None,
    trim: float = 0.0,
    max_steps: int = 100,
) -> Float[Array, " 3"]:
    """Leading direction of centred vectors: the robust Grassmann average.

    Every u_i counts as a one-dimensional subspace weighted by its length: q ← mean of sign(u_i·q) u_i,
    normalised, from the leading principal direction until q stands. Trimming each coordinate's mean breaks
    rotation equivariance, so all is computed in the frame of the principal directions.
    Reference: Hauberg, Feragen, Black, "Grassmann averages for scalable robust PCA", CVPR 2014.

    Args:
        u: centred vectors.
        weights: nonnegative weights.
        trim: share cut from each end of every coordinate, 0 (the plain average) to below 0.5.
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

    def turning(state: tuple[Float[Array, " 3"], Bool[Array, ""], Int[Array, ""]]) -> Bool[Array, ""]:
        return ~state[1] & (state[2] < max_steps)

    def turn(
        state: tuple[Float[Array, " 3"], Bool[Array, ""], Int[Array, ""]],
    ) -> tuple[Float[Array, " 3"], Bool[Array, ""], Int[Array, ""]]:
        q, _, k = state
        side = jnp.where(rotated @ q < 0, -1, 1).astype(u.dtype)
        average = mean(side[:, None] * rotated)
        square = jnp.sum(average**2)
        new = jnp.where(square > 0, average / jnp.sqrt(jnp.where(square > 0, square, 1)), q)
        return new, jnp.all(jnp.abs(new - q) <= 4 * jnp.finfo(u.dtype).eps), k + 1

    leading = jnp.asarray([0.0, 0.0, 1.0], u.dtype)
    q, _, _ = jax.lax.while_loop(turning, turn, (leading, jnp.asarray(False), jnp.asarray(0)))
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
    """The paper's start: v = η₁ × η₂, the robust Grassmann averages that span the mid-points' plane.

    The mid-points are centred on their median first: uncentred, the same start is tens of degrees off.

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
    # eta_2 is tangent at eta_1 but for rounding
    return normalise(jnp.cross(eta_1, normalise(tangent_projection(eta_1, eta_2))))


@jax.default_matmul_precision("highest")
def pca_normal(
    x: Float[Array, "n 3"], y: Float[Array, "n 3"], *, weights: Float[Array, " n"] | None = None
) -> Float[Array, " 3"]:
    """The classical start: the least principal direction of the centred mid-points (paper, Sec. 3.2)."""
    u, weights = _centred_midpoints(x, y, weights)
    return jnp.linalg.eigh((weights[:, None] * u).T @ u)[1][:, 0]


@jax.default_matmul_precision("highest")
def l2_plane(
    x: Float[Array, "n 3"],
    y: Float[Array, "n 3"],
    weights: Float[Array, " n"] | None = None,
    *,
    as_printed: bool = False,
) -> Plane:
    """The least-squares plane, which is the maximum-likelihood one: the baseline without robustness (Eq. 2).

    With the best offset ω = v·m̄ put in, v is the eigenvector of the least eigenvalue of
    sym(Σ x_i y_iᵀ) − n m̄m̄ᵀ. The paper prints H = Σ x_i y_iᵀ, which is right only where Σ m_i = 0.

    Args:
        x: one end of every pair.
        y: the other end.
        weights: nonnegative weights of the pairs.
        as_printed: take the symmetric part of the printed H instead, with the same ω = v·m̄.

    Returns:
        The plane, of canonical sign.
    """
    if weights is None:
        weights = jnp.ones_like(x[:, 0])
    mean = jnp.sum(weights[:, None] * 0.5 * (x + y), axis=0) / jnp.sum(weights)
    # centring both ends on m̄ gives the corrected H without its cancellation
    shift = jnp.zeros_like(mean) if as_printed else mean
    H = (weights[:, None] * (x - shift[None, :])).T @ (y - shift[None, :])
    v = jnp.linalg.eigh(0.5 * (H + H.T))[1][:, 0]
    return Plane(v, jnp.sum(v * mean)).canonical()


def l2_normal(
    x: Float[Array, "n 3"], y: Float[Array, "n 3"], *, weights: Float[Array, " n"] | None = None
) -> Float[Array, " 3"]:
    """The normal of the `l2_plane` as a start."""
    return l2_plane(x, y, weights).normal


NORMALS = {"rga": rga_normal, "pca": pca_normal, "l2": l2_normal}
"""The starts that are one normal, computed from the pairs, by name."""
