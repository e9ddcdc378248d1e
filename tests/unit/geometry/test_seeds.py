"""Seeds become generators; anything else is refused."""

import numpy as np
import pytest

from symjax.errors import InvalidArgumentError
from symjax.geometry.seeds import seeded


def test_a_seed_makes_a_generator_and_a_generator_is_kept():
    for seed in (7, np.int64(7)):
        found = seeded(seed)
        assert found.seed == 7
        assert found.generator.random() == np.random.default_rng(7).random()
    generator = np.random.default_rng(0)
    assert seeded(generator) == (None, generator)


@pytest.mark.parametrize("rng", [-1, 1.0, "a", None, True, [1, 2]])
def test_anything_else_is_refused(rng):
    with pytest.raises(InvalidArgumentError, match="rng must be a seed"):
        seeded(rng)
