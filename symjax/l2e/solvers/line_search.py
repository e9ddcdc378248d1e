"""Armijo's line search along the curves of a retraction.

The search is over φ(t) = f(R_z(t d)). Near the optimum, rounding hides the decrease that Armijo's condition requires. A
step that changes f by no more than rounding is therefore accepted if its slope satisfies Hager and Zhang's approximate
Wolfe condition (SIAM J. Optim. 16, 2005).
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

DECREASE = 1e-4  # c₁ of Nocedal and Wright, Sec. 3.1
MAX_TRIALS = 30
_SHRINK = (0.1, 0.5)  # smallest and largest factor of the interpolated step
_ROUNDING = 4.0  # values within this many units of rounding (of f or 1) count as equal: f sums terms of order one


class Trial(NamedTuple):
    """The curve at step t.

    Attributes:
        step: t.
        point: R_z(t d).
        value: φ(t).
        grad: Riemannian gradient of f at the point.
        slope: φ'(t).
    """

    step: Float[Array, ""]
    point: Float[Array, " d"]
    value: Float[Array, ""]
    grad: Float[Array, " d"]
    slope: Float[Array, ""]


Curve = Callable[[Float[Array, ""]], Trial]


def _is_acceptable(start: Trial, trial: Trial) -> Bool[Array, ""]:
    # a step so short that the bound rounds to φ(0) must still decrease φ
    enough = trial.value <= start.value + DECREASE * trial.step * start.slope
    enough &= trial.value < start.value
    rounding: Float[Array, ""] = _ROUNDING * np.finfo(trial.value.dtype).eps * jnp.maximum(jnp.abs(start.value), 1)
    not_higher = trial.value <= start.value + rounding
    return enough | (not_higher & (trial.slope <= (2 * DECREASE - 1) * start.slope))


def _parabola(lo: Trial, hi: Trial) -> Float[Array, ""]:
    """Returns the minimiser of the parabola through φ(lo), φ'(lo) and φ(hi), as a fraction of the way to hi."""
    width = hi.step - lo.step
    curvature = hi.value - lo.value - lo.slope * width
    return jnp.where(curvature > 0, -0.5 * lo.slope * width / jnp.where(curvature > 0, curvature, 1), 0.5)


def armijo(curve: Curve, start: Trial, step: Float[Array, ""]) -> tuple[Trial, Bool[Array, ""]]:
    """Backtracks from `step` until Armijo's condition holds.

    Args:
        curve: t -> the trial at t.
        start: the trial at t = 0, whose slope is negative.
        step: the first step to try.

    Returns:
        The accepted trial and True, or the last trial and False.
    """

    class State(NamedTuple):
        trial: Trial
        next_step: Float[Array, ""]
        num: Int[Array, ""]

    def should_continue(state: State) -> Bool[Array, ""]:
        return (state.num == 0) | (~_is_acceptable(start, state.trial) & (state.num < MAX_TRIALS))

    def backtrack(state: State) -> State:
        trial = curve(state.next_step)
        shrink = jnp.clip(jnp.nan_to_num(_parabola(start, trial)), *_SHRINK)
        return State(trial, shrink * trial.step, state.num + 1)

    # the first trial is made inside the loop, so that f is compiled once instead of twice
    trial, _, _ = jax.lax.while_loop(should_continue, backtrack, State(start, step, jnp.asarray(0)))
    return trial, _is_acceptable(start, trial)
