"""The generated benchmark."""

import numpy as np
import pytest

from experiments.data import procedural
from symjax.datasets import KINDS
from symjax.errors import InvalidArgumentError


def test_the_generated_benchmark_does_not_depend_on_the_order():
    benchmark = procedural.Procedural(num_points=100)
    late = benchmark.case(5)
    early = list(benchmark.cases(6))[5]
    assert (late.name, late.seed) == (early.name, early.seed)
    np.testing.assert_array_equal(late.points, early.points)


def test_the_generated_benchmark_has_1354_objects_of_kinds_with_planes():
    benchmark = procedural.Procedural(num_points=50)
    last = benchmark.case(procedural.NUM_OBJECTS - 1)
    assert len(last.planes) >= 1
    for k in (-1, 1354):
        with pytest.raises(InvalidArgumentError, match="0 to 1353"):
            benchmark.case(k)
    shares = [KINDS[kind].symmetry for kind in procedural.PROCEDURAL_KINDS]
    assert set(shares) == {"single", "multiple"}
    assert "funk" not in procedural.NAME


def test_another_seed_gives_other_objects():
    one, other = (procedural.Procedural(seed, 50).case(7) for seed in (1, 2))
    assert one.name == other.name
    assert one.diagonal != other.diagonal
