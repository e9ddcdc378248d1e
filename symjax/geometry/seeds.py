"""Generators of random numbers from seeds."""

from typing import NamedTuple, TypeAlias

import numpy as np

from symjax.errors import InvalidArgumentError

Seed: TypeAlias = int | np.integer | np.random.Generator
"""A whole number, at least 0; or a generator of NumPy."""


class Seeded(NamedTuple):
    """A generator and its seed.

    Attributes:
        seed: the seed; None if a generator was passed, whose seed is unknown.
        generator: the generator.
    """

    seed: int | None
    generator: np.random.Generator


def seeded(rng: Seed) -> Seeded:
    """Makes a generator from a seed; a generator is returned itself.

    Raises:
        InvalidArgumentError: if `rng` is neither a whole number, at least 0, nor a generator of NumPy.
    """
    if isinstance(rng, np.random.Generator):
        return Seeded(None, rng)
    if isinstance(rng, (int, np.integer)) and not isinstance(rng, bool) and rng >= 0:
        return Seeded(int(rng), np.random.default_rng(int(rng)))
    raise InvalidArgumentError(f"rng must be a seed (a whole number, at least 0) or a NumPy Generator, got {rng!r}")
