"""Iteratively reweighted least squares, an MM iteration."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.criterion import Expansion, mm_step
from symjax.l2e.solvers import small_eigh
from symjax.l2e.solvers.base import Progress, Solver, iterative_solver, norm, reduces_gradient_only


class State(NamedTuple):
    """State of the solver: ψ about the best point, the steps taken, and whether the last one found no lower value."""

    best: Expansion
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def irls(
    expand: Callable[[Float[Array, " d"]], Expansion], *, max_steps: int | Int[Array, ""], tol: float | Float[Array, ""]
) -> Solver:
    """Minimises by MM steps: every step is the least eigenvector of the reweighted scatter.

    The iteration is monotone and needs no line search. It converges linearly, and slowly if σ is much larger or smaller
    than the noise.

    Args:
        expand: returns the second-order expansion about a point, which determines the MM step.
        max_steps: limit on the steps.
        tol: tolerance of the norm of the Riemannian gradient.
    """

    def init(start: Float[Array, " d"]) -> State:
        return State(expand(start), jnp.asarray(0), jnp.asarray(False))

    def step(state: State) -> State:
        last = state.best
        new = expand(mm_step(last, *small_eigh.eigh(last.scatter)))
        improved = reduces_gradient_only(new.value, norm(new.gradient), last.value, norm(last.gradient))
        accepted = (new.value < last.value) | improved
        best = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), new, last)
        return State(best, state.k + 1, ~accepted)

    def progress(state: State) -> Progress:
        best = state.best
        return Progress(best.point, best.value, norm(best.gradient), state.k, state.stalled)

    return iterative_solver(init, step, progress, max_steps=max_steps, tol=tol)
