"""Line searches along the curves of a retraction.

Both look at φ(t) = f(R_z(t d)) and share one account of rounding: near the optimum f cannot show the decrease
that Armijo's condition asks for, so a step at which f stands still to rounding is accepted on its slope
(Hager and Zhang's approximate Wolfe condition, SIAM J. Optim. 16, 2005).
"""

from collections.abc import Callable
from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

DECREASE = 1e-4  # c₁ of Nocedal and Wright, Sec. 3.1
CURVATURE = 0.9  # c₂, their choice for quasi-Newton directions
MAX_TRIALS = 30
_SHRINK = (0.1, 0.5)  # safeguards of Armijo's interpolated step
_MARGIN = 0.1  # an interpolated step stays this far inside its bracket
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
    point: Float[Array, "d"]
    value: Float[Array, ""]
    grad: Float[Array, "d"]
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


class _Bracket(NamedTuple):
    lo: Trial  # lowest so far that satisfies Armijo's condition
    hi: Trial  # the other end; its step is infinite until the bracket closes
    trial: Trial
    next_step: Float[Array, ""]
    num: Int[Array, ""]


def strong_wolfe(curve: Curve, start: Trial, step: Float[Array, ""]) -> tuple[Trial, Bool[Array, ""]]:
    """Brackets and zooms to a step with |φ'(t)| ≤ c₂|φ'(0)| (Nocedal and Wright, Algorithms 3.5 and 3.6).

    The two stages are one loop: the bracket (lo, hi) starts with hi at infinity, and the next trial is twice
    the last until it closes.

    Args:
        curve: t -> the trial at t.
        start: the trial at t = 0; its slope is negative.
        step: first step tried.

    Returns:
        The trial and True; or, when the trials run out, the lowest step that satisfies Armijo's condition
        alone, and whether there was one.
    """

    def accepted(trial: Trial) -> Bool[Array, ""]:
        return _decreases(start, trial) & (jnp.abs(trial.slope) <= CURVATURE * jnp.abs(start.slope))

    def search_on(bracket: _Bracket) -> Bool[Array, ""]:
        return (bracket.num == 0) | (~accepted(bracket.trial) & (bracket.num < MAX_TRIALS))

    def narrow(bracket: _Bracket) -> _Bracket:
        lo, hi, num = bracket.lo, bracket.hi, bracket.num
        trial = curve(bracket.next_step)
        lower = _decreases(start, trial) & (trial.value < lo.value)
        turned = trial.slope * (hi.step - lo.step) >= 0
        # a trial no lower than lo closes the bracket; a lower one becomes lo, and where it climbs towards hi
        # the old lo is the other end
        new_hi = jax.tree.map(lambda a, b, c: jnp.where(lower, jnp.where(turned, a, b), c), lo, hi, trial)
        new_lo = jax.tree.map(lambda a, b: jnp.where(lower, a, b), trial, lo)
        open_ended = jnp.isinf(new_hi.step)
        fraction = jnp.clip(jnp.nan_to_num(_parabola(new_lo, new_hi), nan=0.5), _MARGIN, 1 - _MARGIN)
        inside = new_lo.step + fraction * (new_hi.step - new_lo.step)
        return _Bracket(new_lo, new_hi, trial, jnp.where(open_ended, 2 * trial.step, inside), num + 1)

    infinity = start._replace(step=jnp.full_like(start.step, jnp.inf))
    bracket = jax.lax.while_loop(search_on, narrow, _Bracket(start, infinity, start, step, jnp.asarray(0)))
    done = accepted(bracket.trial)
    best = jax.tree.map(lambda a, b: jnp.where(done, a, b), bracket.trial, bracket.lo)
    return best, best.step > 0


LINE_SEARCHES = {"armijo": armijo, "wolfe": strong_wolfe}
