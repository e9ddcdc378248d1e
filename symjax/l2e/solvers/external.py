"""An optimistix minimiser as a solver, in tangent charts."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Float, Int

from symjax.l2e.jax_config import full_precision
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.base import Progress, Solver, iterative_solver, norm, reduces_gradient_only

STEPS_PER_ROUND = 32
"""Largest number of steps in one chart. A chart covers only the half sphere about its centre and is distorted towards
the boundary of that half, so far from the centre a new chart is better."""


def external(
    minimiser: optx.AbstractMinimiser[Any, Any, Any],
    fun: Callable[[Float[Array, " 4"]], Float[Array, ""]],
    *,
    max_steps: int | Int[Array, ""],
    tol: float | Float[Array, ""],
) -> Solver:
    """Makes a solver on S² × R that runs a minimiser in rounds, in the tangent chart t ↦ R_z(B t) at the current z.

    The solver converges by the Riemannian gradient. The minimiser's own tolerances only end a round. A round that finds
    no lower value ends the solve.

    Args:
        minimiser: the optimistix minimiser.
        fun: function of z = (v, ω).
        max_steps: limit on the rounds.
        tol: tolerance of the norm of the Riemannian gradient.

    Returns:
        The solver. Its steps are rounds.
    """
    value_and_grad = jax.value_and_grad(fun)

    def value_and_grad_norm(z: Float[Array, " 4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        value, grad = value_and_grad(z)
        return value, norm(SPHERE_LINE.project(z, grad))

    def init(z0: Float[Array, " 4"]) -> Progress:
        return Progress(z0, *value_and_grad_norm(z0), jnp.asarray(0), jnp.asarray(False))

    @full_precision
    def round_(last: Progress) -> Progress:
        z = last.point
        basis = SPHERE_LINE.basis(z)

        def from_chart(t: Float[Array, " 3"]) -> Float[Array, " 4"]:
            return SPHERE_LINE.retract(z, basis @ t)

        # throw=False, because a round may end before the minimiser has converged
        solution: Any = optx.minimise(
            lambda t, _: fun(from_chart(t)),
            minimiser,
            jnp.zeros(3, z.dtype),
            max_steps=STEPS_PER_ROUND,
            throw=False,
        )
        new = from_chart(solution.value)
        value, grad_norm = value_and_grad_norm(new)
        accepted = (value < last.value) | reduces_gradient_only(value, grad_norm, last.value, last.grad_norm)
        moved = Progress(new, value, grad_norm, last.num_steps + 1, jnp.asarray(False))
        stayed = last._replace(num_steps=last.num_steps + 1, stalled=jnp.asarray(True))
        progress: Progress = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), moved, stayed)
        return progress

    return iterative_solver(init, round_, lambda last: last, max_steps=max_steps, tol=tol)
