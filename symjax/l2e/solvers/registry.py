"""The solvers by name, and the limits that all of them have."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np

from symjax.geometry.checks import number, whole
from symjax.l2e.criterion import Criterion
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.alternating import alternation
from symjax.l2e.solvers.base import Limits, Solver
from symjax.l2e.solvers.irls import reweighting
from symjax.l2e.solvers.names import SOLVER_NAMES, AnySolver, check_solver
from symjax.l2e.solvers.newton import newton
from symjax.l2e.solvers.rbfgs import riemannian_bfgs


def _newton(criterion: Criterion, limits: Limits) -> Solver:
    return newton(criterion.expand, **limits._asdict())


def _irls(criterion: Criterion, limits: Limits) -> Solver:
    return reweighting(criterion.expand, **limits._asdict())


def _rbfgs(criterion: Criterion, limits: Limits) -> Solver:
    return riemannian_bfgs(criterion.value, manifold=SPHERE_LINE, **limits._asdict())


def _alternating(criterion: Criterion, limits: Limits) -> Solver:
    return alternation(criterion.value, **limits._asdict())


MAX_STEPS = 200

SOLVERS: dict[str, Callable[[Criterion, Limits], Solver]] = dict(
    zip(SOLVER_NAMES, (_newton, _irls, _rbfgs, _alternating), strict=True)
)
"""Each takes the criterion and the limits."""

_TOL_POWER = dict(zip(SOLVER_NAMES, (2 / 3, 2 / 3, 2 / 3, 1 / 2), strict=True))
# the alternation's ω solver stops where f itself shows no decrease any more, which is at a gradient of about eps^(1/2)

_EXTERNAL_TOL_POWER = 2 / 5
"""So does a minimiser of another package, now and then some times before that."""


def make_solver(solver: AnySolver, criterion: Criterion, limits: Limits) -> Solver:
    """The solver of a name, or of a minimiser of optimistix."""
    if isinstance(solver, str):
        return SOLVERS[solver](criterion, limits)
    # optimistix is imported where it is used
    from symjax.l2e.solvers.external import external

    return external(solver, criterion.value, **limits._asdict())


def default_tol(solver: AnySolver, dtype: jnp.dtype) -> float:
    """A power of the type's rounding that the solver reaches."""
    power = _TOL_POWER[solver] if isinstance(solver, str) else _EXTERNAL_TOL_POWER
    return float(jnp.finfo(dtype).eps) ** power


def checked_limits(solver: AnySolver, max_steps: int, tol: float | None, dtype: Any) -> Limits:
    """The options that every solver has.

    Raises:
        InvalidArgumentError: for an unknown solver, a negative limit, or a tolerance not above 0.
    """
    check_solver(solver)
    max_steps = whole("max_steps", max_steps, 0)
    tol = default_tol(solver, dtype) if tol is None else number("tol", tol, above=0)
    # NumPy until a compiled function takes them, as in `pad_pairs`
    known: Any = np.asarray(max_steps), np.asarray(tol, dtype)
    return Limits(*known)
