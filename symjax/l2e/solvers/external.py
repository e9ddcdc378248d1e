"""A minimiser of optimistix as a solver, in tangent charts."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import optimistix as optx
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.base import Minimum, Solver, ending, norm
from symjax.l2e.solvers.newton import ROUNDING

STEPS_OF_A_ROUND = 32
"""Steps in one chart. A chart reaches only the half sphere about its centre, and is ever more distorted towards its
rim: far from the centre the next one is better."""


class State(NamedTuple):
    """State of the solver: the point, its value and gradient norm, the rounds, whether the last found nothing lower."""

    z: Float[Array, "4"]
    value: Float[Array, ""]
    grad_norm: Float[Array, ""]
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def external(
    minimiser: optx.AbstractMinimiser,
    fun: Callable[[Float[Array, "4"]], Float[Array, ""]],
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

    def at(z: Float[Array, "4"]) -> tuple[Float[Array, ""], Float[Array, ""]]:
        value, grad = value_and_grad(z)
        return value, norm(SPHERE_LINE.project(z, grad))

    def init(z0: Float[Array, "4"]) -> State:
        return State(z0, *at(z0), jnp.asarray(0), jnp.asarray(False))

    def going(state: State) -> Bool[Array, ""]:
        far = jnp.isfinite(state.value) & (state.grad_norm > tol)
        return far & (state.k < max_steps) & ~state.stalled

    @jax.default_matmul_precision("highest")
    def round_(state: State) -> State:
        z = state.z
        basis = SPHERE_LINE.basis(z)

        def from_chart(t: Float[Array, "3"]) -> Float[Array, "4"]:
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
        rounding = ROUNDING * jnp.finfo(value.dtype).eps * jnp.maximum(jnp.abs(state.value), 1)
        level = (value <= state.value + rounding) & (grad_norm < state.grad_norm)
        accepted = (value < state.value) | level
        moved = State(new, value, grad_norm, state.k + 1, jnp.asarray(False))
        stayed = state._replace(k=state.k + 1, stalled=jnp.asarray(True))
        return jax.tree.map(lambda a, b: jnp.where(accepted, a, b), moved, stayed)

    def finish(state: State) -> Minimum:
        z, value, grad_norm, k, stalled = state
        return Minimum(z, value, grad_norm, k, ending(grad_norm, tol, value, stalled))

    return Solver(init, going, round_, finish)
