"""Algorithm 1 of the paper: ω and v in turn."""

from collections.abc import Callable
from typing import Any, cast

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from symjax.l2e.manifolds import SPHERE, SPHERE_LINE
from symjax.l2e.solvers.base import Minimum, Progress, Solver, norm, solve, solver_of
from symjax.l2e.solvers.rbfgs import minimise

INNER_STEPS = 64  # limit on the steps of one inner solve


def alternation(
    fun: Callable[[Float[Array, " 4"]], Float[Array, ""]],
    *,
    max_steps: int | Int[Array, ""] = 200,
    tol: float | Float[Array, ""] = 1e-10,
) -> Solver:
    """Minimises over ω by BFGS given v, then over v by Riemannian BFGS given ω, until both gradients vanish.

    Algorithm 1 of the paper. It converges linearly, and many times more slowly than Riemannian BFGS of both at once.

    Args:
        fun: function of z = (v, ω) on S² × R.
        max_steps: limit on the rounds.
        tol: bound on the norm of the joint Riemannian gradient.

    Returns:
        The solver; its steps are rounds.
    """
    # imported where it is used: `import symjax` stays cheap
    import optimistix as optx

    value_and_grad = jax.value_and_grad(fun)
    # annotated loosely: optimistix types atol as a float, and takes a traced one
    omega_solver: Any = optx.BFGS(rtol=0.0, atol=cast(float, 0.5 * tol))

    def joint(z: Float[Array, " 4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        value, grad = value_and_grad(z)
        return value, norm(SPHERE_LINE.project(z, grad))

    @jax.default_matmul_precision("highest")
    def round_(last: Progress) -> Progress:
        z = last.point
        v = z[:3]
        # throw=False: under vmap one solve that runs out of steps must not fail the others
        along_the_normal: Any = optx.minimise(
            lambda omega, _: fun(jnp.append(v, omega)),
            omega_solver,
            z[3],
            max_steps=INNER_STEPS,
            throw=False,
        )
        omega = along_the_normal.value
        inner = minimise(
            lambda v: fun(jnp.append(v, omega)),
            v,
            manifold=SPHERE,
            max_steps=INNER_STEPS,
            tol=0.5 * tol,
        )
        new = jnp.append(inner.point, omega)
        new_value, grad_norm = joint(new)
        return Progress(new, new_value, grad_norm, last.num_steps + 1, jnp.all(new == z))

    def init(z0: Float[Array, " 4"]) -> Progress:
        return Progress(z0, *joint(z0), jnp.asarray(0), jnp.asarray(False))

    return solver_of(init, round_, lambda last: last, max_steps=max_steps, tol=tol)


@jax.default_matmul_precision("highest")
def alternate(fun: Callable[[Float[Array, " 4"]], Float[Array, ""]], z0: Float[Array, " 4"], **options: Any) -> Minimum:
    """Minimises from one start by the `alternation`, which documents the options; `num_steps` counts rounds."""
    return solve(alternation(fun, **options), z0)
