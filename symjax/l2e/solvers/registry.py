"""The solvers by name."""

from collections.abc import Callable

import jax.numpy as jnp

from symjax.l2e.criterion import Criterion
from symjax.l2e.manifolds import SPHERE_LINE
from symjax.l2e.solvers.alternating import alternation
from symjax.l2e.solvers.base import Limits, Solver
from symjax.l2e.solvers.irls import reweighting
from symjax.l2e.solvers.newton import newton
from symjax.l2e.solvers.rbfgs import riemannian_bfgs


def _newton(criterion: Criterion, limits: Limits, line_search: str) -> Solver:
    return newton(criterion.expand, max_steps=limits.max_steps, tol=limits.tol)


def _mm(criterion: Criterion, limits: Limits, line_search: str) -> Solver:
    return reweighting(criterion.expand, max_steps=limits.max_steps, tol=limits.tol)


def _joint(criterion: Criterion, limits: Limits, line_search: str) -> Solver:
    return riemannian_bfgs(criterion.value, manifold=SPHERE_LINE, line_search=line_search, **limits._asdict())


def _alternating(criterion: Criterion, limits: Limits, line_search: str) -> Solver:
    return alternation(criterion.value, line_search=line_search, **limits._asdict())


SOLVERS: dict[str, Callable[[Criterion, Limits, str], Solver]] = {
    "newton": _newton,
    "mm": _mm,
    "joint": _joint,
    "alternating": _alternating,
}
"""Each takes the criterion, the limits, and the line search, which only the last two have."""

_TOL_POWER = {"newton": 2 / 3, "mm": 2 / 3, "joint": 2 / 3, "alternating": 1 / 2}
# the alternation's ω solver stops where f itself shows no decrease any more, which is at a gradient of about eps^(1/2)


def default_tol(solver: str, dtype: jnp.dtype) -> float:
    """A power of the type's rounding that the solver reaches."""
    return float(jnp.finfo(dtype).eps) ** _TOL_POWER[solver]
