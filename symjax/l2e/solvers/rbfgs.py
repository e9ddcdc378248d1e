"""Riemannian BFGS."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.manifolds import Manifold
from symjax.l2e.solvers.base import Minimum, Progress, Solver, norm, solve, solver_of
from symjax.l2e.solvers.line_search import Trial, armijo

FIRST_STEP = 0.1  # radians: a longer first step, the Hessian unknown, leaps out of the start's basin
MAX_LENGTH = 0.5  # radians: no later step is longer
CAUTION = 1e-4  # Manopt's constant of the cautious update
GROWTH = 3.0  # of the inverse Hessian at negative curvature, where unscaled steps would crawl
ORTHOGONAL = 1e-6  # a direction this near to a level line is replaced by steepest descent


class State(NamedTuple):
    """State of the solver, in the letters of Nocedal and Wright, Sec. 6.1.

    Attributes:
        z_k: point on the manifold, in ambient coordinates.
        f_k: value at z_k.
        g_k: Riemannian gradient at z_k.
        H_k: inverse Hessian in ambient coordinates; only its tangent part acts.
        k: steps taken.
        stalled: the last line search failed.
    """

    z_k: Float[Array, " d"]
    f_k: Float[Array, ""]
    g_k: Float[Array, " d"]
    H_k: Float[Array, "d d"]
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def riemannian_bfgs(
    fun: Callable[[Float[Array, " d"]], Float[Array, ""]],
    *,
    manifold: Manifold,
    max_steps: int | Int[Array, ""] = 200,
    tol: float | Float[Array, ""] = 1e-10,
) -> Solver:
    """Riemannian BFGS for a function on a manifold.

    The inverse Hessian stays in ambient coordinates and moves with the point by an isometric transport,
    H ← T H Tᵀ; it is updated only where ⟨s, y⟩/⟨s, s⟩ ≥ 1e-4‖grad f‖ (the cautious update), and scaled by
    ⟨s, y⟩/⟨y, y⟩ before the first. The paper's Manifold-BFGS. Reference: Huang, Gallivan, Absil, "A Broyden
    class of quasi-Newton methods for Riemannian optimization", SIAM J. Optim. 25 (2015).

    Args:
        fun: differentiable function of a point in ambient coordinates; best scaled to a Hessian of order one.
        manifold: `symjax.l2e.manifolds.SPHERE` or `SPHERE_LINE`.
        max_steps: limit on the steps.
        tol: bound on the norm of the Riemannian gradient.

    Returns:
        The solver; its starts are points on the manifold.
    """
    value_and_grad = jax.value_and_grad(fun)

    @jax.default_matmul_precision("highest")
    def body_fun(state: State) -> State:
        z_k, f_k, g_k, H_k, k, _ = state
        p_k = -manifold.project(z_k, H_k @ g_k)
        p_k = jnp.where(jnp.sum(p_k * g_k) < -ORTHOGONAL * norm(p_k) * norm(g_k), p_k, -g_k)

        def curve(t: Float[Array, ""]) -> Trial:
            z, velocity = jax.jvp(lambda s: manifold.retract(z_k, s * p_k), (t,), (jnp.ones_like(t),))
            f, g = value_and_grad(z)
            g = manifold.project(z, g)
            return Trial(t, z, f, g, jnp.sum(g * velocity))

        length = jnp.where(k == 0, FIRST_STEP, MAX_LENGTH).astype(f_k.dtype)
        start = Trial(jnp.zeros_like(f_k), z_k, f_k, g_k, jnp.sum(g_k * p_k))
        trial, found = armijo(curve, start, jnp.minimum(1, length / norm(p_k)))
        found &= jnp.any(trial.point != z_k)

        T = manifold.transport(z_k, trial.point)
        s_k = T @ (trial.step * p_k)
        y_k = trial.grad - T @ g_k
        H_k = T @ H_k @ T.T
        sy, ss, yy = jnp.sum(s_k * y_k), jnp.sum(s_k * s_k), jnp.sum(y_k * y_k)
        cautious = sy > CAUTION * norm(g_k) * ss
        rho_k = 1 / jnp.where(cautious, sy, 1)
        eye = jnp.eye(len(z_k), dtype=z_k.dtype)
        H_k = jnp.where(k == 0, sy / jnp.where(cautious, yy, 1) * eye, H_k)
        V = eye - rho_k * jnp.outer(s_k, y_k)
        H_new = V @ H_k @ V.T + rho_k * jnp.outer(s_k, s_k)
        # f curved down along the step: it holds no scale to learn, and the step was too short
        H_kept = jnp.where(sy < 0, GROWTH * H_k, H_k)
        H_k = jnp.where(cautious, H_new, jnp.where(k == 0, eye, H_kept))
        moved = State(trial.point, trial.value, trial.grad, H_k, k + 1, ~found)
        stayed = state._replace(k=k + 1, stalled=~found)
        return jax.tree.map(lambda a, b: jnp.where(found, a, b), moved, stayed)

    def init(z0: Float[Array, " d"]) -> State:
        f_0, g_0 = value_and_grad(z0)
        eye = jnp.eye(len(z0), dtype=z0.dtype)
        return State(z0, f_0, manifold.project(z0, g_0), eye, jnp.asarray(0), jnp.asarray(False))

    def progress(state: State) -> Progress:
        return Progress(state.z_k, state.f_k, norm(state.g_k), state.k, state.stalled)

    return solver_of(init, body_fun, progress, max_steps=max_steps, tol=tol)


@jax.default_matmul_precision("highest")
def minimise(fun: Callable[[Float[Array, " d"]], Float[Array, ""]], z0: Float[Array, " d"], **options: Any) -> Minimum:
    """Minimises a function on a manifold from one start by `riemannian_bfgs`, which documents the options.

    Never raises under a trace: read `status`.
    """
    return solve(riemannian_bfgs(fun, **options), z0)
