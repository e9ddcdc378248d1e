"""What a solver is: how it starts, whether it goes on, one step, and what it has found."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from symjax.l2e.status import Status

State = Any

ROUNDING = 32.0
"""Units of rounding, of ψ or 1, within which two values are equal: exponents are sums of larger terms."""


class Minimum(NamedTuple):
    """What a solver has found.

    Attributes:
        point: the point found.
        value: the function there.
        grad_norm: norm of the Riemannian gradient there.
        num_steps: steps taken.
        status: how the solve ended, the number of a `Status`.
    """

    point: Float[Array, " d"]
    value: Float[Array, ""]
    grad_norm: Float[Array, ""]
    num_steps: Int[Array, ""]
    status: Int[Array, ""]


class Progress(NamedTuple):
    """Where a solver stands.

    Attributes:
        point: the best point so far.
        value: the function there.
        grad_norm: norm of the Riemannian gradient there.
        num_steps: steps taken.
        stalled: whether the last step found nothing lower.
    """

    point: Float[Array, " d"]
    value: Float[Array, ""]
    grad_norm: Float[Array, ""]
    num_steps: Int[Array, ""]
    stalled: Bool[Array, ""]


class Limits(NamedTuple):
    """When a solver stops.

    Attributes:
        max_steps: limit on the steps.
        tol: bound on the norm of the Riemannian gradient.
    """

    max_steps: Int[Array, ""] | int
    tol: Float[Array, ""]


class Solver(NamedTuple):
    """A solver as its parts, so that one loop runs any of them, for one start or for many.

    Attributes:
        init: start -> state.
        going: state -> whether another step is to be taken.
        step: state -> the next state.
        finish: state -> the minimum (and what else is to be kept).
    """

    init: Callable[[Float[Array, " d"]], State]
    going: Callable[[State], Bool[Array, ""]]
    step: Callable[[State], State]
    finish: Callable[[State], Any]


def solver_of(
    init: Callable[[Float[Array, " d"]], State],
    step: Callable[[State], State],
    progress: Callable[[State], Progress],
    *,
    max_steps: int | Int[Array, ""],
    tol: float | Float[Array, ""],
) -> Solver:
    """The solver that steps until its gradient is within tol, nothing lower is found, or its steps are used up."""

    def going(state: State) -> Bool[Array, ""]:
        at = progress(state)
        far = jnp.isfinite(at.value) & (at.grad_norm > tol)
        return far & (at.num_steps < max_steps) & ~at.stalled

    def finish(state: State) -> Minimum:
        point, value, grad_norm, num_steps, stalled = progress(state)
        return Minimum(point, value, grad_norm, num_steps, ending(grad_norm, tol, value, stalled))

    return Solver(init, going, step, finish)


def solve(solver: Solver, start: Float[Array, " d"]) -> Any:
    """Runs a solver from one start; gives what its `finish` gives."""
    return solver.finish(jax.lax.while_loop(solver.going, solver.step, solver.init(start)))


def with_start(solver: Solver, point_of: Callable[[Float[Array, " s"]], Float[Array, " d"]]) -> Solver:
    """A solver that begins at `point_of(start)`, and that finishes with the minimum and this point."""

    def init(start: Float[Array, " s"]) -> State:
        point = point_of(start)
        return solver.init(point), point

    return Solver(
        init=init,
        going=lambda state: solver.going(state[0]),
        step=lambda state: (solver.step(state[0]), state[1]),
        finish=lambda state: (solver.finish(state[0]), state[1]),
    )


def norm(u: Float[Array, " d"]) -> Float[Array, ""]:
    """Euclidean length, summed elementwise: `jnp.linalg.norm` of float32 runs in TF32 on some devices."""
    return jnp.sqrt(jnp.sum(u * u))


def is_level(
    value: Float[Array, ""], grad_norm: Float[Array, ""], last_value: Float[Array, ""], last_grad_norm: Float[Array, ""]
) -> Bool[Array, ""]:
    """Whether a step changed the value by no more than its rounding, and made the gradient smaller."""
    rounding = ROUNDING * jnp.finfo(value.dtype).eps * jnp.maximum(jnp.abs(last_value), 1)
    return (jnp.abs(last_value - value) <= rounding) & (grad_norm < last_grad_norm)


def ending(
    grad_norm: Float[Array, ""], tol: float | Float[Array, ""], value: Float[Array, ""], stalled: Bool[Array, ""]
) -> Int[Array, ""]:
    """The status of a solve from its last gradient norm, value, and whether its last step found nothing lower."""
    status = jnp.where(stalled, jnp.int32(Status.STALLED), jnp.int32(Status.MAX_STEPS_REACHED))
    status = jnp.where(grad_norm <= tol, jnp.int32(Status.SUCCESSFUL), status)
    return jnp.where(jnp.isfinite(value) & jnp.isfinite(grad_norm), status, jnp.int32(Status.NONFINITE))
