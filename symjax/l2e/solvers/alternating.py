"""Algorithm 1 of the paper: alternating minimisation over ω and v."""

from collections.abc import Callable
from typing import Any, cast

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from symjax.l2e.jax_config import full_precision
from symjax.l2e.manifolds import SPHERE, SPHERE_LINE
from symjax.l2e.solvers.base import Minimum, Progress, Solver, iterative_solver, norm, solve
from symjax.l2e.solvers.rbfgs import minimise

INNER_STEPS = 64  # limit on the steps of one inner solve


def alternation(
    fun: Callable[[Float[Array, " 4"]], Float[Array, ""]],
    *,
    max_steps: int | Int[Array, ""] = 200,
    tol: float | Float[Array, ""] = 1e-10,
) -> Solver:
    """Makes a solver that minimises over ω by BFGS and over v by Riemannian BFGS in turn (Algorithm 1 of the paper).

    It stops when both gradients vanish. It converges linearly, and many times more slowly than Riemannian BFGS over
    both variables.

    Args:
        fun: function of z = (v, ω) on S² × R.
        max_steps: limit on the rounds.
        tol: tolerance of the norm of the joint Riemannian gradient.

    Returns:
        The solver. Its steps are rounds.
    """
    # imported here to keep `import symjax` fast
    import optimistix as optx

    value_and_grad = jax.value_and_grad(fun)
    # cast, because optimistix annotates atol as float but accepts a traced one
    omega_solver: Any = optx.BFGS(rtol=0.0, atol=cast(float, 0.5 * tol))

    def value_and_grad_norm(z: Float[Array, " 4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        value, grad = value_and_grad(z)
        return value, norm(SPHERE_LINE.project(z, grad))

    @full_precision
    def round_(last: Progress) -> Progress:
        z = last.point
        v = z[:3]
        # throw=False, because under vmap a solve that reaches max_steps must not make the others fail
        over_omega: Any = optx.minimise(
            lambda omega, _: fun(jnp.append(v, omega)),
            omega_solver,
            z[3],
            max_steps=INNER_STEPS,
            throw=False,
        )
        omega = over_omega.value
        over_v = minimise(
            lambda v: fun(jnp.append(v, omega)),
            v,
            manifold=SPHERE,
            max_steps=INNER_STEPS,
            tol=0.5 * tol,
        )
        new = jnp.append(over_v.point, omega)
        new_value, grad_norm = value_and_grad_norm(new)
        return Progress(new, new_value, grad_norm, last.num_steps + 1, jnp.all(new == z))

    def init(z0: Float[Array, " 4"]) -> Progress:
        return Progress(z0, *value_and_grad_norm(z0), jnp.asarray(0), jnp.asarray(False))

    return iterative_solver(init, round_, lambda last: last, max_steps=max_steps, tol=tol)


@full_precision
def alternate(fun: Callable[[Float[Array, " 4"]], Float[Array, ""]], z0: Float[Array, " 4"], **options: Any) -> Minimum:
    """Minimises from one start by `alternation`, which documents the options. `num_steps` counts rounds."""
    minimum: Minimum = solve(alternation(fun, **options), z0)
    return minimum
