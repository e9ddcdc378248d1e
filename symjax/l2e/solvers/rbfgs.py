"""Riemannian BFGS."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.jax_config import full_precision
from symjax.l2e.manifolds import Manifold
from symjax.l2e.solvers.base import Minimum, Progress, Solver, iterative_solver, norm, solve
from symjax.l2e.solvers.line_search import Trial, armijo

FIRST_STEP = 0.1  # in radians: before the Hessian is known, a longer step leaves the basin of the start
MAX_STEP = 0.5  # in radians: limit on the length of all later steps
CAUTION = 1e-4  # Manopt's constant of the cautious update
GROWTH = 3.0  # factor of the inverse Hessian at negative curvature, without which steps would stay short
ORTHOGONAL = 1e-6  # a direction whose cosine with −grad f is smaller is replaced by steepest descent


class State(NamedTuple):
    """State of the solver, in the letters of Nocedal and Wright, Sec. 6.1.

    Attributes:
        z_k: point on the manifold, in ambient coordinates.
        f_k: value at z_k.
        g_k: Riemannian gradient at z_k.
        H_k: approximate inverse Hessian in ambient coordinates; only its tangent part acts.
        k: number of steps taken.
        stalled: whether the last line search failed.
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
    """Makes a Riemannian BFGS solver for a function on a manifold (the paper's Manifold-BFGS).

    The inverse Hessian H is kept in ambient coordinates and follows the point by an isometric transport, H ← T H Tᵀ. It
    is updated only if ⟨s, y⟩/⟨s, s⟩ ≥ 1e-4‖grad f‖ (the cautious update), and scaled by ⟨s, y⟩/⟨y, y⟩ before the first
    update. Reference: Huang, Gallivan, Absil, "A Broyden class of quasi-Newton methods for Riemannian optimization",
    SIAM J. Optim. 25 (2015).

    Args:
        fun: differentiable function of a point in ambient coordinates, preferably scaled to a Hessian of order one.
        manifold: `symjax.l2e.manifolds.SPHERE` or `SPHERE_LINE`.
        max_steps: limit on the steps.
        tol: tolerance of the norm of the Riemannian gradient.

    Returns:
        The solver. `symjax.l2e.solvers.base.solve` runs it from one start, a point on the manifold, and
        `symjax.l2e.solvers.batched.solve_batch` from many.

    Example:
        The minimiser of vᵀHv on the sphere is the eigenvector of the least eigenvalue:

        >>> import jax.numpy as jnp
        >>> from symjax.l2e.manifolds import SPHERE
        >>> from symjax.l2e.solvers.base import solve
        >>> solver = riemannian_bfgs(lambda v: v[0] ** 2 + 2 * v[1] ** 2 + 3 * v[2] ** 2, manifold=SPHERE, tol=1e-5)
        >>> minimum = solve(solver, jnp.array([0.6, 0.64, 0.48]))
        >>> print(abs(minimum.point[0]).round(3), minimum.value.round(3))
        1.0 1.0
    """
    value_and_grad = jax.value_and_grad(fun)

    @full_precision
    def body_fun(state: State) -> State:
        z_k, f_k, g_k, H_k, k, _ = state
        p_k = -manifold.project(z_k, H_k @ g_k)
        p_k = jnp.where(jnp.sum(p_k * g_k) < -ORTHOGONAL * norm(p_k) * norm(g_k), p_k, -g_k)

        def curve(t: Float[Array, ""]) -> Trial:
            z, velocity = jax.jvp(lambda s: manifold.retract(z_k, s * p_k), (t,), (jnp.ones_like(t),))
            f, g = value_and_grad(z)
            g = manifold.project(z, g)
            return Trial(t, z, f, g, jnp.sum(g * velocity))

        length = jnp.where(k == 0, FIRST_STEP, MAX_STEP).astype(f_k.dtype)
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
        # at negative curvature the step gives no scale for H, and it was too short
        H_kept = jnp.where(sy < 0, GROWTH * H_k, H_k)
        H_k = jnp.where(cautious, H_new, jnp.where(k == 0, eye, H_kept))
        moved = State(trial.point, trial.value, trial.grad, H_k, k + 1, ~found)
        stayed = state._replace(k=k + 1, stalled=~found)
        new: State = jax.tree.map(lambda a, b: jnp.where(found, a, b), moved, stayed)
        return new

    def init(z0: Float[Array, " d"]) -> State:
        f_0, g_0 = value_and_grad(z0)
        eye = jnp.eye(len(z0), dtype=z0.dtype)
        return State(z0, f_0, manifold.project(z0, g_0), eye, jnp.asarray(0), jnp.asarray(False))

    def progress(state: State) -> Progress:
        return Progress(state.z_k, state.f_k, norm(state.g_k), state.k, state.stalled)

    return iterative_solver(init, body_fun, progress, max_steps=max_steps, tol=tol)


@full_precision
def minimise(fun: Callable[[Float[Array, " d"]], Float[Array, ""]], z0: Float[Array, " d"], **options: Any) -> Minimum:
    """Minimises a function on a manifold from one start by `riemannian_bfgs`.

    Args:
        fun: differentiable function of a point in ambient coordinates.
        z0: the start, a point on the manifold.
        **options: options of `riemannian_bfgs`; `manifold` is required.

    Returns:
        The minimum. A solve that fails raises no error: read its `status`.

    Example:
        >>> import jax.numpy as jnp
        >>> from symjax.l2e.manifolds import SPHERE
        >>> from symjax.l2e.status import sentences
        >>> z0 = jnp.array([0.6, 0.64, 0.48])
        >>> minimum = minimise(lambda v: v[0] ** 2 + 2 * v[1] ** 2 + 3 * v[2] ** 2, z0, manifold=SPHERE, tol=1e-5)
        >>> print(abs(minimum.point[0]).round(3), sentences(minimum.status))
        1.0 Converged: the Riemannian gradient is within tol.
    """
    minimum: Minimum = solve(riemannian_bfgs(fun, **options), z0)
    return minimum
