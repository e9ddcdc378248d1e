"""A figure that methods are compared in."""

from typing import NamedTuple


class Measure(NamedTuple):
    """A column of a table.

    Attributes:
        title: with the unit.
        rises: whether more is better.
        tie: largest difference that says nothing.
    """

    title: str
    rises: bool = True
    tie: float = 0.0
