"""The generated benchmark."""

import numpy as np
import pytest

from experiments.data import procedural
from symjax.datasets import KINDS
from symjax.errors import InvalidArgumentError


def test_an_object_does_not_depend_on_which_were_generated_before():
    late = procedural.generated_object(5, 100)
    early = [procedural.generated_object(k, 100) for k in range(6)][5]
    assert (late.name, late.seed) == (early.name, early.seed)
    np.testing.assert_array_equal(late.points, early.points)


def test_the_generated_benchmark_has_1354_objects_of_kinds_with_planes():
    last = procedural.generated_object(procedural.NUM_OBJECTS - 1, 50)
    assert len(last.planes) >= 1
    for k in (-1, 1354):
        with pytest.raises(InvalidArgumentError, match=r"no object .*: choose from 0 to 1353"):
            procedural.generated_object(k)
    shares = [KINDS[kind].symmetry for kind in procedural.PROCEDURAL_KINDS]
    assert set(shares) == {"single", "multiple"}
    assert "funk" not in procedural.NAME


def test_another_seed_gives_other_objects():
    one, other = (procedural.generated_object(7, 50, seed=seed) for seed in (1, 2))
    assert one.name == other.name
    assert one.diagonal != other.diagonal
