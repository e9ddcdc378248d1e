"""The choices of Sym-HKS: the default is among the values of each choice, and the others change the result."""

import numpy as np
import pytest

from experiments.data.cases import generate_case
from experiments.data.corruptions import trials
from experiments.framework.options import split_names
from experiments.studies.symhks import ablation
from experiments.studies.symhks.choices import CHOICES, DEFAULT, Variant
from symjax import SymHKS


@pytest.fixture(scope="module")
def trial():
    return next(trials([generate_case("quadruped", 500, 0)], ["clean"]))


@pytest.mark.parametrize("choice", CHOICES)
def test_every_choice_contains_the_default_once(choice):
    assert list(CHOICES[choice].values()).count(DEFAULT) == 1
    assert len(set(CHOICES[choice].values())) == len(CHOICES[choice])


def test_all_choices_are_varied_by_default():
    assert split_names(ablation.Config().choices, CHOICES) == list(CHOICES)


def test_numeric_values_are_ascending():
    for values in CHOICES.values():
        numbers = [value for value in values if not isinstance(value, str)]
        assert numbers == sorted(numbers)


def test_a_changed_choice_changes_the_result(trial):
    default = ablation._detect(DEFAULT, "clean", trial)
    again = ablation._detect(DEFAULT, "clean", trial)
    np.testing.assert_array_equal(again.plane.normal, default.plane.normal)
    for choice, value in (("Laplacian", "library"), ("neighbours of a star", 10), ("neighbours h", 25)):
        other = ablation._detect(CHOICES[choice][value], "clean", trial)
        assert not np.array_equal(other.pairs.rows, default.pairs.rows), choice
    wide = ablation._detect(CHOICES["sigma in spacings"][2.8], "clean", trial)
    assert wide.sigma == pytest.approx(2 * default.sigma)
    np.testing.assert_array_equal(wide.pairs.rows, default.pairs.rows)


def test_a_method_that_fails_has_a_row(trial):
    # no two points are this far apart
    variant = Variant(SymHKS(separation=100.0))
    row = ablation._row(variant, "clean", trial)
    assert row["failed"]
    assert row["angle"] == ablation.FAILURE_ANGLE
    assert row["correct_pairs"] == 0.0
