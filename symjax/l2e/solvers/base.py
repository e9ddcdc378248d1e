"""The interface of the solvers, the loop that runs them, and how a solve ends."""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from symjax.geometry.arrays import JitInput
from symjax.l2e.status import Status

State = Any

ROUNDING = 32.0
"""Values of ψ within this many units of rounding (of ψ or 1) count as equal: exponents are sums of larger terms."""


class Minimum(NamedTuple):
    """The result of a solver.

    Attributes:
        point: the minimiser.
        value: value of the function there.
        grad_norm: norm of the Riemannian gradient there.
        num_steps: number of steps taken.
        status: how the solver ended, as the number of a `Status`.
    """

    point: Float[Array, " d"]
    value: Float[Array, ""]
    grad_norm: Float[Array, ""]
    num_steps: Int[Array, ""]
    status: Int[Array, ""]


class Progress(NamedTuple):
    """The progress of a solver.

    Attributes:
        point: the best point so far.
        value: value of the function there.
        grad_norm: norm of the Riemannian gradient there.
        num_steps: number of steps taken.
        stalled: whether the last step found no lower value.
    """

    point: Float[Array, " d"]
    value: Float[Array, ""]
    grad_norm: Float[Array, ""]
    num_steps: Int[Array, ""]
    stalled: Bool[Array, ""]


class Limits(NamedTuple):
    """The stopping rule of a solver.

    Attributes:
        max_steps: limit on the steps.
        tol: tolerance of the norm of the Riemannian gradient.
    """

    max_steps: Int[JitInput, ""] | int
    tol: Float[JitInput, ""]


class Solver(NamedTuple):
    """A solver as four functions, so that one loop runs any solver, from one start or from many.

    Attributes:
        init: start -> state.
        should_continue: state -> whether to take another step.
        step: state -> the next state.
        finish: state -> the `Minimum` (or a tuple that begins with it, see `with_start`).
    """

    init: Callable[[Float[Array, " d"]], State]
    should_continue: Callable[[State], Bool[Array, ""]]
    step: Callable[[State], State]
    finish: Callable[[State], Any]


def iterative_solver(
    init: Callable[[Float[Array, " d"]], State],
    step: Callable[[State], State],
    progress: Callable[[State], Progress],
    *,
    max_steps: int | Int[Array, ""],
    tol: float | Float[Array, ""],
) -> Solver:
    """Makes a solver that steps until the gradient is within tol, it stalls, or it reaches max_steps."""

    def should_continue(state: State) -> Bool[Array, ""]:
        current = progress(state)
        unconverged = jnp.isfinite(current.value) & (current.grad_norm > tol)
        return unconverged & (current.num_steps < max_steps) & ~current.stalled

    def finish(state: State) -> Minimum:
        point, value, grad_norm, num_steps, stalled = progress(state)
        return Minimum(point, value, grad_norm, num_steps, final_status(grad_norm, tol, value, stalled))

    return Solver(init, should_continue, step, finish)


def solve(solver: Solver, start: Float[Array, " d"]) -> Any:
    """Runs a solver from one start and returns the result of its `finish`."""
    return solver.finish(jax.lax.while_loop(solver.should_continue, solver.step, solver.init(start)))


def with_start(solver: Solver, point_of: Callable[[Float[Array, " s"]], Float[Array, " d"]]) -> Solver:
    """Makes a solver begin at `point_of(start)` and return the minimum together with this point."""

    def init(start: Float[Array, " s"]) -> State:
        point = point_of(start)
        return solver.init(point), point

    return Solver(
        init=init,
        should_continue=lambda state: solver.should_continue(state[0]),
        step=lambda state: (solver.step(state[0]), state[1]),
        finish=lambda state: (solver.finish(state[0]), state[1]),
    )


def norm(u: Float[Array, " d"]) -> Float[Array, ""]:
    """Computes ‖u‖ elementwise, because `jnp.linalg.norm` of float32 runs in TF32 on some devices."""
    return jnp.sqrt(jnp.sum(u * u))


def reduces_gradient_only(
    value: Float[Array, ""], grad_norm: Float[Array, ""], last_value: Float[Array, ""], last_grad_norm: Float[Array, ""]
) -> Bool[Array, ""]:
    """Returns whether a step reduced the gradient, and changed the value by no more than its rounding error."""
    rounding: Float[Array, ""] = ROUNDING * np.finfo(value.dtype).eps * jnp.maximum(jnp.abs(last_value), 1)
    return (jnp.abs(last_value - value) <= rounding) & (grad_norm < last_grad_norm)


def final_status(
    grad_norm: Float[Array, ""], tol: float | Float[Array, ""], value: Float[Array, ""], stalled: Bool[Array, ""]
) -> Int[Array, ""]:
    """Returns the status of a solve that ended with this gradient norm and value, and stalled or not."""
    status = jnp.where(stalled, jnp.int32(Status.STALLED), jnp.int32(Status.MAX_STEPS_REACHED))
    status = jnp.where(grad_norm <= tol, jnp.int32(Status.SUCCESSFUL), status)
    return jnp.where(jnp.isfinite(value) & jnp.isfinite(grad_norm), status, jnp.int32(Status.NONFINITE))
