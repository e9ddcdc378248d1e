"""The solvers by name, and the limits that all of them take."""

from collections.abc import Callable
from typing import Any

import numpy as np

from symjax.geometry.checks import number, whole
from symjax.l2e.criterion import Criterion
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.alternating import alternation
from symjax.l2e.solvers.base import Limits, Solver
from symjax.l2e.solvers.irls import irls
from symjax.l2e.solvers.names import SOLVER_NAMES, AnySolver, check_solver
from symjax.l2e.solvers.newton import newton
from symjax.l2e.solvers.rbfgs import riemannian_bfgs


def _newton(criterion: Criterion, limits: Limits) -> Solver:
    return newton(criterion.expand, **limits._asdict())


def _irls(criterion: Criterion, limits: Limits) -> Solver:
    return irls(criterion.expand, **limits._asdict())


def _rbfgs(criterion: Criterion, limits: Limits) -> Solver:
    return riemannian_bfgs(criterion.value, manifold=SPHERE_LINE, **limits._asdict())


def _alternating(criterion: Criterion, limits: Limits) -> Solver:
    return alternation(criterion.value, **limits._asdict())


MAX_STEPS = 200

SOLVERS: dict[str, Callable[[Criterion, Limits], Solver]] = dict(
    zip(SOLVER_NAMES, (_newton, _irls, _rbfgs, _alternating), strict=True)
)
"""Functions of the criterion and the limits that return a solver, by name."""

_TOL_POWER = dict(zip(SOLVER_NAMES, (2 / 3, 2 / 3, 2 / 3, 1 / 2), strict=True))
# the alternating solver's minimiser over ω stops when f no longer decreases, at a gradient of about eps^(1/2)

_EXTERNAL_TOL_POWER = 2 / 5
"""Optimistix minimisers stop at about eps^(1/2) too, and sometimes at a few times that."""


def make_solver(solver: AnySolver, criterion: Criterion, limits: Limits) -> Solver:
    """Makes the solver from its name, or from an optimistix minimiser."""
    if isinstance(solver, str):
        return SOLVERS[solver](criterion, limits)
    # imported here because it imports optimistix
    from symjax.l2e.solvers.external import external

    return external(solver, criterion.value, **limits._asdict())


def default_tol(solver: AnySolver, dtype: np.dtype) -> float:
    """Returns the tolerance that the solver reaches, a power of the machine epsilon of the type."""
    power = _TOL_POWER[solver] if isinstance(solver, str) else _EXTERNAL_TOL_POWER
    tol: float = float(np.finfo(dtype).eps) ** power
    return tol


def checked_limits(solver: AnySolver, max_steps: int, tol: float | None, dtype: Any) -> Limits:
    """Checks the options that every solver takes.

    Raises:
        InvalidArgumentError: if the solver is unknown, the limit is negative, or the tolerance is not positive.
    """
    check_solver(solver)
    max_steps = whole("max_steps", max_steps, 0)
    tol = default_tol(solver, dtype) if tol is None else number("tol", tol, above=0)
    # in NumPy until a compiled function takes them, as in `pad_pairs`
    limits: Any = np.asarray(max_steps), np.asarray(tol, dtype)
    return Limits(*limits)
