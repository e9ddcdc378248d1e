"""A generated benchmark: 1 354 objects of `symjax.datasets`.

The benchmark of Funk et al. has the same number of objects; the two have nothing else in common.

Object number k depends only on k and the seed, so objects can be generated on demand and in any order. Kinds alternate
with k, so that consecutive objects cover all kinds equally.
"""

from experiments.data.cases import Case, generate_case
from symjax.datasets import KINDS
from symjax.errors import InvalidArgumentError

NAME = "procedural-1354"
"""Name in the tables; it avoids the name of Funk's benchmark, whose results are not comparable."""

NUM_OBJECTS = 1354

PROCEDURAL_KINDS = tuple(kind for kind, about in KINDS.items() if about.symmetry in ("single", "multiple"))
"""Kinds of objects with one mirror plane or several."""

SEED = 1
"""Not 0, because with 0 some objects would be those of `generated_cases`, on which thresholds were chosen."""


def kind(k: int) -> str:
    """Returns the kind of object number k, which is also its name."""
    return PROCEDURAL_KINDS[k % len(PROCEDURAL_KINDS)]


def generated_object(k: int, num_points: int = 5000, *, seed: int = SEED) -> Case:
    """Generates object number k in a random pose; its name is its kind, and its seed is unique.

    Raises:
        InvalidArgumentError: if k is not from 0 to 1353.
    """
    if not 0 <= k < NUM_OBJECTS:
        raise InvalidArgumentError(f"{NAME} has no object {k}: choose from 0 to {NUM_OBJECTS - 1}")
    return generate_case(kind(k), num_points, NUM_OBJECTS * seed + k)
