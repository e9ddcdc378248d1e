"""The choices of Sym-HKS: every one has the default among its values, and changes the answer."""

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
def test_every_choice_has_the_default_once(choice):
    assert list(CHOICES[choice].values()).count(DEFAULT) == 1
    assert len(set(CHOICES[choice].values())) == len(CHOICES[choice])


def test_the_command_takes_all_choices_by_default():
    assert split_names(ablation.Config().choices, CHOICES) == list(CHOICES)


def test_numbers_rise_so_that_they_can_be_drawn():
    for values in CHOICES.values():
        numbers = [value for value in values if not isinstance(value, str)]
        assert numbers == sorted(numbers)


def test_a_changed_part_changes_the_answer(trial):
    default = ablation._answer(DEFAULT, "clean", trial)
    again = ablation._answer(DEFAULT, "clean", trial)
    np.testing.assert_array_equal(again.plane.normal, default.plane.normal)
    for choice, value in (("Laplacian", "library's"), ("neighbours of a star", 10), ("neighbours h", 25)):
        other = ablation._answer(CHOICES[choice][value], "clean", trial)
        assert not np.array_equal(other.pairs.rows, default.pairs.rows), choice
    wide = ablation._answer(CHOICES["sigma in spacings"][2.8], "clean", trial)
    assert wide.sigma == pytest.approx(2 * default.sigma)
    np.testing.assert_array_equal(wide.pairs.rows, default.pairs.rows)


def test_a_method_that_gives_up_is_counted_and_not_left_out(trial):
    # no pair is so far apart
    variant = Variant(SymHKS(separation=100.0))
    row = ablation._row(variant, "clean", trial)
    assert row["gave_up"]
    assert row["angle"] == ablation.GAVE_UP
    assert row["right_matches"] == 0.0
