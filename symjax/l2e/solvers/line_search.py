"""Armijo's line search along the curves of a retraction.

It looks at φ(t) = f(R_z(t d)). Near the optimum f cannot show the decrease that Armijo's condition asks for, so a step
at which f stands still to rounding is accepted on its slope (Hager and Zhang's approximate Wolfe condition,
SIAM J. Optim. 16, 2005).
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

DECREASE = 1e-4  # c₁ of Nocedal and Wright, Sec. 3.1
MAX_TRIALS = 30
_SHRINK = (0.1, 0.5)  # safeguards of the interpolated step
_ROUNDING = 4.0  # units of rounding, of f or 1, within which two values are equal: f is a sum of terms of order one


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


def _decreases(start: Trial, trial: Trial) -> Bool[Array, ""]:
    # a step so short that the bound itself rounds to φ(0) must decrease, not stand still
    enough = trial.value <= start.value + DECREASE * trial.step * start.slope
    enough &= trial.value < start.value
    rounding = _ROUNDING * jnp.finfo(trial.value.dtype).eps * jnp.maximum(jnp.abs(start.value), 1)
    level = trial.value <= start.value + rounding
    return enough | (level & (trial.slope <= (2 * DECREASE - 1) * start.slope))


def _parabola(lo: Trial, hi: Trial) -> Float[Array, ""]:
    """Minimiser of the parabola with φ(lo), φ'(lo) and φ(hi), as a fraction of the way from lo to hi."""
    width = hi.step - lo.step
    bend = hi.value - lo.value - lo.slope * width
    return jnp.where(bend > 0, -0.5 * lo.slope * width / jnp.where(bend > 0, bend, 1), 0.5)


def armijo(curve: Curve, start: Trial, step: Float[Array, ""]) -> tuple[Trial, Bool[Array, ""]]:
    """Backtracks from `step` until Armijo's condition holds.

    Args:
        curve: t -> the trial at t.
        start: the trial at t = 0; its slope is negative.
        step: first step tried.

    Returns:
        The accepted trial and True, or the last trial and False.
    """

    class State(NamedTuple):
        trial: Trial
        next_step: Float[Array, ""]
        num: Int[Array, ""]

    def search_on(state: State) -> Bool[Array, ""]:
        return (state.num == 0) | (~_decreases(start, state.trial) & (state.num < MAX_TRIALS))

    def backtrack(state: State) -> State:
        trial = curve(state.next_step)
        shrink = jnp.clip(jnp.nan_to_num(_parabola(start, trial)), *_SHRINK)
        return State(trial, shrink * trial.step, state.num + 1)

    # the first trial is made inside the loop: one copy of f to compile, not two
    trial, _, _ = jax.lax.while_loop(search_on, backtrack, State(start, step, jnp.asarray(0)))
    return trial, _decreases(start, trial)
