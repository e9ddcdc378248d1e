"""The MM iteration: least squares, reweighted."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.criterion import Expansion, reweighted
from symjax.l2e.solvers import small_eigh
from symjax.l2e.solvers.base import Minimum, Solver, ending, norm
from symjax.l2e.solvers.newton import ROUNDING


class State(NamedTuple):
    """State of the iteration: ψ about the best point, steps taken, and whether the last found nothing lower."""

    at: Expansion
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def reweighting(
    expand: Callable[[Float[Array, "d"]], Expansion], *, max_steps: int | Int[Array, ""], tol: float | Float[Array, ""]
) -> Solver:
    """Minorise-maximise: the least eigenvector of the reweighted scatter, again and again.

    Monotone, without a line search; it converges linearly, slowly where σ is large or small beside the noise.

    Args:
        expand: gives what is minimised about a point, and the next point.
        max_steps: limit on the steps.
        tol: bound on the norm of the Riemannian gradient.
    """

    def init(start: Float[Array, "d"]) -> State:
        return State(expand(start), jnp.asarray(0), jnp.asarray(False))

    def going(state: State) -> Bool[Array, ""]:
        far = jnp.isfinite(state.at.value) & (norm(state.at.gradient) > tol)
        return far & (state.k < max_steps) & ~state.stalled

    def step(state: State) -> State:
        at = state.at
        new = expand(reweighted(at, *small_eigh.eigh(at.scatter)))
        rounding = ROUNDING * jnp.finfo(at.value.dtype).eps * jnp.maximum(jnp.abs(at.value), 1)
        level = (new.value <= at.value + rounding) & (norm(new.gradient) < norm(at.gradient))
        accepted = (new.value < at.value) | level
        best = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), new, at)
        return State(best, state.k + 1, ~accepted)

    def finish(state: State) -> Minimum:
        grad_norm = norm(state.at.gradient)
        status = ending(grad_norm, tol, state.at.value, state.stalled)
        return Minimum(state.at.point, state.at.value, grad_norm, state.k, status)

    return Solver(init, going, step, finish)
