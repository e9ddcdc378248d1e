"""Trust-region Newton with exact derivatives."""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.criterion import Expansion, reweighted
from symjax.l2e.manifolds import SPHERE_LINE, tangent_basis
from symjax.l2e.solvers import small_eigh
from symjax.l2e.solvers.base import Progress, Solver, is_level, norm, solver_of

FIRST_RADIUS = 0.5  # radians, and radii of the cloud
MAX_RADIUS = 1.0
LEAST_CURVATURE = 1e-9  # of a direction: the trust region bounds the step anyway
DECREASE = 1e-4  # share of the predicted decrease that a step must bring
POOR, GOOD = 0.25, 0.75  # shares at which the trust region shrinks and grows
FAR_SHARE = 0.25  # an MM step of this share of the Newton step is preferred where ψ curves down


class State(NamedTuple):
    """State of the solver.

    Attributes:
        at: ψ to second order about the best point.
        radius: of the trust region, in the tangent chart.
        rejected: the last step was, so the next is an MM step.
        k: steps taken.
        stalled: an MM step was rejected: nothing lower is to be found.
    """

    at: Expansion
    radius: Float[Array, ""]
    rejected: Bool[Array, ""]
    k: Int[Array, ""]
    stalled: Bool[Array, ""]


def newton(
    expand: Callable[[Float[Array, " d"]], Expansion], *, max_steps: int | Int[Array, ""], tol: float | Float[Array, ""]
) -> Solver:
    """Newton's method on S² × R with the exact Hessian, safeguarded.

    Where the Hessian is indefinite, each eigenvalue counts by its size (the saddle-free Newton step) unless an MM
    step goes about as far; a rejected step is followed by an MM step from the best point, which cannot fail but by
    rounding. One pass over the pairs a step.

    Args:
        expand: gives what is minimised to second order about a point of S² × R (or S² × R²), and the MM step there.
        max_steps: limit on the steps.
        tol: bound on the norm of the Riemannian gradient.
    """

    def init(start: Float[Array, " d"]) -> State:
        at = expand(start)
        return State(at, jnp.full_like(at.value, FIRST_RADIUS), jnp.asarray(False), jnp.asarray(0), jnp.asarray(False))

    def step(state: State) -> State:
        at = state.at
        (values, vectors), least_squares = _eigen(at)
        along = jnp.sum(vectors * at.gradient[:, None], axis=0)
        t = -jnp.sum(vectors * (along / jnp.maximum(jnp.abs(values), LEAST_CURVATURE))[None, :], axis=1)
        length = norm(t)
        t = t * jnp.minimum(1, state.radius / jnp.where(length > 0, length, 1))
        short = jnp.minimum(length, state.radius)
        bent = jnp.sum(at.hessian * t[None, :], axis=1)
        predicted = -jnp.sum(t * (at.gradient + 0.5 * bent))

        again = reweighted(at, *least_squares)
        leap = (jnp.min(values) <= 0) & (norm(again - at.point) > FAR_SHARE * short)
        reweight = state.rejected | leap
        new = expand(jnp.where(reweight, again, SPHERE_LINE.retract(at.point, _tangent(at.point, t))))

        decrease = at.value - new.value
        enough = (decrease > 0) & (decrease >= jnp.where(reweight, 0, DECREASE * predicted))
        accepted = enough | is_level(new.value, norm(new.gradient), at.value, norm(at.gradient))

        share = decrease / jnp.where(predicted > 0, predicted, 1)
        grown = jnp.where(share > GOOD, jnp.minimum(2 * state.radius, MAX_RADIUS), state.radius)
        radius = jnp.where(share < POOR, 0.5 * short, grown)
        radius = jnp.where(reweight, state.radius, jnp.where(accepted, radius, 0.25 * short))
        best = jax.tree.map(lambda a, b: jnp.where(accepted, a, b), new, at)
        return State(best, radius, ~accepted, state.k + 1, reweight & ~accepted)

    def progress(state: State) -> Progress:
        at = state.at
        return Progress(at.point, at.value, norm(at.gradient), state.k, state.stalled)

    return solver_of(init, step, progress, max_steps=max_steps, tol=tol)


def _eigen(at: Expansion) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Eigenvalues and eigenvectors of the Hessian and of the scatter: of one size, they are one computation."""
    if at.hessian.shape != at.scatter.shape:
        return small_eigh.eigh(at.hessian), small_eigh.eigh(at.scatter)
    values, vectors = jax.vmap(small_eigh.eigh)(jnp.stack([at.hessian, at.scatter]))
    return (values[0], vectors[0]), (values[1], vectors[1])


def _tangent(point: Float[Array, " d"], t: Float[Array, " k"]) -> Float[Array, " d"]:
    basis = tangent_basis(point[:3])
    return jnp.concatenate([basis[:, 0] * t[0] + basis[:, 1] * t[1], t[2:]])
