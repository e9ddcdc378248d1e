"""A generated benchmark: 1 354 objects of `symjax.datasets`.

That is the number of objects in the benchmark of Funk et al., and all that the two have in common.

Number k depends on the seed and on k alone: objects are made when they are asked for, in any order, and any run of
consecutive numbers has all kinds in equal shares.
"""

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


def generated_object(k: int, num_points: int = 5000, *, seed: int = SEED) -> Case:
    """Object number k in a random pose; its name is its kind, its seed tells it from all others.

    Raises:
        InvalidArgumentError: k is not from 0 to 1353.
    """
    if not 0 <= k < NUM_OBJECTS:
        raise InvalidArgumentError(f"object {k} of {NAME}: 0 to {NUM_OBJECTS - 1} expected")
    return made(kind(k), num_points, NUM_OBJECTS * seed + k)
