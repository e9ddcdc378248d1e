"""Trust-region Newton with exact derivatives."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.criterion import Expansion, mm_step
from symjax.l2e.manifolds import SPHERE_LINE, tangent_basis
from symjax.l2e.solvers import small_eigh
from symjax.l2e.solvers.base import Progress, Solver, iterative_solver, norm, reduces_gradient_only

FIRST_RADIUS = 0.5  # radians, and radii of the cloud
MAX_RADIUS = 1.0
MIN_CURVATURE = 1e-9  # smaller eigenvalues count as this one; the trust region bounds the step anyway
MIN_DECREASE_RATIO = 1e-4  # actual to predicted decrease, at which a step is accepted
POOR_RATIO, GOOD_RATIO = 0.25, 0.75  # actual to predicted decrease, at which the trust region shrinks and grows
MM_LENGTH_RATIO = 0.25  # at negative curvature an MM step is taken if it is this long, relative to the Newton step


class State(NamedTuple):
    """State of the solver.

    Attributes:
        best: second-order expansion of ψ about the best point.
        radius: radius of the trust region, in the tangent chart.
        rejected: whether the last step was rejected. The next step is then an MM step.
        k: number of steps taken.
        stalled: whether an MM step was rejected. Then no lower value can be found.
    """

    best: Expansion
    radius: Float[Array, ""]
    rejected: Bool[Array, ""]
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def newton(
    expand: Callable[[Float[Array, " d"]], Expansion], *, max_steps: int | Int[Array, ""], tol: float | Float[Array, ""]
) -> Solver:
    """Minimises by Newton's method on S² × R with the exact Hessian, a trust region and MM steps.

    If the Hessian is indefinite, the step uses the absolute values of the eigenvalues (saddle-free Newton), unless the
    MM step is about as long. A rejected step is followed by an MM step from the best point, which fails only by
    rounding. Every step takes one pass over the pairs.

    Args:
        expand: returns the second-order expansion about a point of S² × R (or S² × R²), which determines the MM step.
        max_steps: limit on the steps.
        tol: tolerance of the norm of the Riemannian gradient.
    """

    def init(start: Float[Array, " d"]) -> State:
        first = expand(start)
        radius = jnp.full_like(first.value, FIRST_RADIUS)
        return State(first, radius, jnp.asarray(False), jnp.asarray(0), jnp.asarray(False))

    def step(state: State) -> State:
        last = state.best
        (values, vectors), scatter_eigen = _eigen(last)
        slopes = jnp.sum(vectors * last.gradient[:, None], axis=0)
        t = -jnp.sum(vectors * (slopes / jnp.maximum(jnp.abs(values), MIN_CURVATURE))[None, :], axis=1)
        length = norm(t)
        t = t * jnp.minimum(1, state.radius / jnp.where(length > 0, length, 1))
        length = jnp.minimum(length, state.radius)
        hessian_t = jnp.sum(last.hessian * t[None, :], axis=1)
        predicted = -jnp.sum(t * (last.gradient + 0.5 * hessian_t))

        mm_point = mm_step(last, *scatter_eigen)
        mm_is_long = (jnp.min(values) <= 0) & (norm(mm_point - last.point) > MM_LENGTH_RATIO * length)
        use_mm = state.rejected | mm_is_long
        new = expand(jnp.where(use_mm, mm_point, SPHERE_LINE.retract(last.point, _tangent(last.point, t))))

        decrease = last.value - new.value
        enough = (decrease > 0) & (decrease >= jnp.where(use_mm, 0, MIN_DECREASE_RATIO * predicted))
        accepted = enough | reduces_gradient_only(new.value, norm(new.gradient), last.value, norm(last.gradient))

        ratio = decrease / jnp.where(predicted > 0, predicted, 1)
        grown = jnp.where(ratio > GOOD_RATIO, jnp.minimum(2 * state.radius, MAX_RADIUS), state.radius)
        radius = jnp.where(ratio < POOR_RATIO, 0.5 * length, grown)
        radius = jnp.where(use_mm, state.radius, jnp.where(accepted, radius, 0.25 * length))
        best = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), new, last)
        return State(best, radius, ~accepted, state.k + 1, use_mm & ~accepted)

    def progress(state: State) -> Progress:
        best = state.best
        return Progress(best.point, best.value, norm(best.gradient), state.k, state.stalled)

    return iterative_solver(init, step, progress, max_steps=max_steps, tol=tol)


def _eigen(
    expansion: Expansion,
) -> tuple[tuple[Float[Array, " k"], Float[Array, "k k"]], tuple[Float[Array, " 3"], Float[Array, "3 3"]]]:
    """Computes eigenvalues and eigenvectors of the Hessian and the scatter, together if they have the same size."""
    hessian, scatter = expansion.hessian, expansion.scatter
    if hessian.shape != scatter.shape:
        return small_eigh.eigh(hessian), small_eigh.eigh(scatter)
    values, vectors = jax.vmap(small_eigh.eigh)(jnp.stack([hessian, scatter]))
    return (values[0], vectors[0]), (values[1], vectors[1])


def _tangent(point: Float[Array, " d"], t: Float[Array, " k"]) -> Float[Array, " d"]:
    basis = tangent_basis(point[:3])
    return jnp.concatenate([basis[:, 0] * t[0] + basis[:, 1] * t[1], t[2:]])
