"""The names of the solvers, and the check of a `solver` argument. This module does not import JAX."""

import sys
from typing import TYPE_CHECKING, Any, TypeAlias

from symjax.errors import InvalidArgumentError
from symjax.geometry.checks import choice

if TYPE_CHECKING:
    from optimistix import AbstractMinimiser

    AnySolver: TypeAlias = str | AbstractMinimiser[Any, Any, Any]
else:
    # optimistix would import JAX
    AnySolver = Any
"""The name of a solver, or an optimistix minimiser."""

SOLVER_NAMES = ("newton", "irls", "rbfgs", "alternating")

_RENAMED = {"joint": "rbfgs", "mm": "irls"}


def is_external(solver: Any) -> bool:
    """Returns whether the solver is an optimistix minimiser. It cannot be one before optimistix is imported."""
    optimistix = sys.modules.get("optimistix")
    return optimistix is not None and isinstance(solver, optimistix.AbstractMinimiser)


def check_solver(solver: Any) -> None:
    """Checks that a solver is one of `SOLVER_NAMES`, or an optimistix minimiser without arrays.

    Raises:
        InvalidArgumentError: if it is not.
    """
    if is_external(solver):
        try:
            hash(solver)
        except TypeError as problem:
            raise InvalidArgumentError(
                "the options of an optimistix minimiser are compiled in: pass them as numbers, not as arrays"
            ) from problem
        return
    if not isinstance(solver, str):
        raise InvalidArgumentError(f"solver {solver!r} is neither a name nor an optimistix minimiser")
    if solver in _RENAMED:
        raise InvalidArgumentError(f"solver {solver!r} is now called {_RENAMED[solver]!r}")
    choice("solver", solver, SOLVER_NAMES)
