"""The solvers' names, and the check of what a caller gives as a solver. No JAX is needed to read them."""

import sys
from typing import TYPE_CHECKING, Any, TypeAlias

from symjax.errors import InvalidArgumentError
from symjax.geometry.checks import choice

if TYPE_CHECKING:
    from optimistix import AbstractMinimiser

    AnySolver: TypeAlias = str | AbstractMinimiser
else:
    # optimistix would import JAX
    AnySolver = Any
"""A solver by name, or a minimiser of optimistix."""

SOLVER_NAMES = ("newton", "irls", "rbfgs", "alternating")

_RENAMED = {"joint": "rbfgs", "mm": "irls"}


def is_external(solver: Any) -> bool:
    """Whether the solver is a minimiser of optimistix: there is none before optimistix is imported."""
    optimistix = sys.modules.get("optimistix")
    return optimistix is not None and isinstance(solver, optimistix.AbstractMinimiser)


def check_solver(solver: Any) -> None:
    """Refuses what is no solver.

    Raises:
        InvalidArgumentError: unless it is one of `SOLVER_NAMES`, or a minimiser of optimistix that holds no arrays.
    """
    if is_external(solver):
        try:
            hash(solver)
        except TypeError as problem:
            raise InvalidArgumentError(
                "a minimiser of optimistix is compiled for its options: give them as numbers, not as arrays"
            ) from problem
        return
    if not isinstance(solver, str):
        raise InvalidArgumentError(f"solver {solver!r} is neither a name nor a minimiser of optimistix")
    if solver in _RENAMED:
        raise InvalidArgumentError(f"solver {solver!r} is now called {_RENAMED[solver]!r}")
    choice("solver", solver, SOLVER_NAMES)
