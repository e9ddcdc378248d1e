"""The methods that `detect` and the command line know by name.

Each is imported when it is used: the command line lists the names without importing what the methods need.
"""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from symjax.method.protocol import Method


def _robust() -> "Method":
    from symjax.robust.method import Robust

    return Robust()


def _sym_hks() -> "Method":
    from symjax.symhks.method import SymHKS

    return SymHKS()


NAMED: "dict[str, Callable[[], Method]]" = {
    "robust": _robust,
    "sym-hks": _sym_hks,
}
"""For each name, the function that returns the method with its default options."""

METHODS = tuple(NAMED)
"""Names of the methods."""
