"""The MM iteration: least squares, reweighted."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.criterion import Expansion, reweighted
from symjax.l2e.solvers import small_eigh
from symjax.l2e.solvers.base import Progress, Solver, is_level, norm, solver_of


class State(NamedTuple):
    """State of the iteration: ψ about the best point, steps taken, and whether the last found nothing lower."""

    at: Expansion
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def reweighting(
    expand: Callable[[Float[Array, " d"]], Expansion], *, max_steps: int | Int[Array, ""], tol: float | Float[Array, ""]
) -> Solver:
    """Minorise-maximise: the least eigenvector of the reweighted scatter, again and again.

    Monotone, without a line search; it converges linearly, slowly where σ is large or small beside the noise.

    Args:
        expand: gives what is minimised about a point, and the next point.
        max_steps: limit on the steps.
        tol: bound on the norm of the Riemannian gradient.
    """

    def init(start: Float[Array, " d"]) -> State:
        return State(expand(start), jnp.asarray(0), jnp.asarray(False))

    def step(state: State) -> State:
        at = state.at
        new = expand(reweighted(at, *small_eigh.eigh(at.scatter)))
        level = is_level(new.value, norm(new.gradient), at.value, norm(at.gradient))
        accepted = (new.value < at.value) | level
        best = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), new, at)
        return State(best, state.k + 1, ~accepted)

    def progress(state: State) -> Progress:
        at = state.at
        return Progress(at.point, at.value, norm(at.gradient), state.k, state.stalled)

    return solver_of(init, step, progress, max_steps=max_steps, tol=tol)
