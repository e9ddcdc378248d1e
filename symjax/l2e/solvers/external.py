"""A minimiser of optimistix as a solver, in tangent charts."""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Float, Int

from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.base import Progress, Solver, is_level, norm, solver_of

STEPS_OF_A_ROUND = 32
"""Steps in one chart. A chart reaches only the half sphere about its centre, and is ever more distorted towards its
rim: far from the centre the next one is better."""


def external(
    minimiser: optx.AbstractMinimiser,
    fun: Callable[[Float[Array, " 4"]], Float[Array, ""]],
    *,
    max_steps: int | Int[Array, ""],
    tol: float | Float[Array, ""],
) -> Solver:
    """Minimises on S² × R by rounds of a minimiser in the tangent chart t ↦ R_z(B t) at the current point z.

    Whether it has converged is judged by the Riemannian gradient, not by the minimiser's own tolerances: those say when
    a round ends. A round that brings no lower value ends the solve.

    Args:
        minimiser: the minimiser.
        fun: function of z = (v, ω).
        max_steps: limit on the rounds.
        tol: bound on the norm of the Riemannian gradient.

    Returns:
        The solver; its steps are rounds.
    """
    value_and_grad = jax.value_and_grad(fun)

    def at(z: Float[Array, " 4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        value, grad = value_and_grad(z)
        return value, norm(SPHERE_LINE.project(z, grad))

    def init(z0: Float[Array, " 4"]) -> Progress:
        return Progress(z0, *at(z0), jnp.asarray(0), jnp.asarray(False))

    @jax.default_matmul_precision("highest")
    def round_(last: Progress) -> Progress:
        z = last.point
        basis = SPHERE_LINE.basis(z)

        def from_chart(t: Float[Array, " 3"]) -> Float[Array, " 4"]:
            return SPHERE_LINE.retract(z, basis @ t)

        # throw=False: a round may end before the minimiser has converged
        ended: Any = optx.minimise(
            lambda t, _: fun(from_chart(t)),
            minimiser,
            jnp.zeros(3, z.dtype),
            max_steps=STEPS_OF_A_ROUND,
            throw=False,
        )
        new = from_chart(ended.value)
        value, grad_norm = at(new)
        accepted = (value < last.value) | is_level(value, grad_norm, last.value, last.grad_norm)
        moved = Progress(new, value, grad_norm, last.num_steps + 1, jnp.asarray(False))
        stayed = last._replace(num_steps=last.num_steps + 1, stalled=jnp.asarray(True))
        return jax.tree.map(lambda a, b: jnp.where(accepted, a, b), moved, stayed)

    return solver_of(init, round_, lambda last: last, max_steps=max_steps, tol=tol)
