"""A generated benchmark: 1 354 objects of `symjax.datasets`.

That is the number of objects in the benchmark of Funk et al., and all that the two have in common.

Number k depends on the seed and on k alone: objects are made when they are asked for, in any order, and any run of
consecutive numbers has all kinds in equal shares.
"""

from collections.abc import Iterator
from typing import NamedTuple

from experiments.data.cases import Case, made
from symjax.datasets import KINDS
from symjax.errors import InvalidArgumentError

NAME = "procedural-1354"
"""What tables call it: a figure on it is no figure on the benchmark of Funk et al."""

NUM_OBJECTS = 1354

PROCEDURAL_KINDS = tuple(kind for kind, about in KINDS.items() if about.symmetry in ("single", "multiple"))
"""The kinds with one plane or with several."""

SEED = 1
"""With 0 some objects would be those of `cases.generated`, on which thresholds were chosen."""


def kind(k: int) -> str:
    """The kind of object number k, which is its name."""
    return PROCEDURAL_KINDS[k % len(PROCEDURAL_KINDS)]


class Procedural(NamedTuple):
    """The benchmark of a seed.

    Attributes:
        seed: which 1 354 objects.
        num_points: points of a cloud.
    """

    seed: int = SEED
    num_points: int = 5000

    def case(self, k: int) -> Case:
        """Object number k in a random pose; its name is its kind, its seed tells it from all others.

        Raises:
            InvalidArgumentError: k is not from 0 to 1353.
        """
        if not 0 <= k < NUM_OBJECTS:
            raise InvalidArgumentError(f"object {k} of {NAME}: 0 to {NUM_OBJECTS - 1} expected")
        return made(kind(k), self.num_points, NUM_OBJECTS * self.seed + k)

    def cases(self, most: int = NUM_OBJECTS) -> Iterator[Case]:
        """The first objects, made one by one."""
        return (self.case(k) for k in range(min(most, NUM_OBJECTS)))
