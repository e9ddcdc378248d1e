"""Options of a wrong type are refused like those out of their range."""

import jax.numpy as jnp
import numpy as np
import pytest

from symjax.errors import InvalidArgumentError
from symjax.geometry import checks


@pytest.mark.parametrize(
    "value", [True, np.True_, 2.5, 3.0, "3", None, float("nan"), 1, np.int64(1), [3], np.ones(2, int)]
)
def test_other_types_and_small_numbers_are_no_whole_numbers(value):
    with pytest.raises(InvalidArgumentError, match="count must be a whole number, at least 2, got"):
        checks.whole("count", value, 2)


@pytest.mark.parametrize("value", [2, np.int32(2), np.uint8(2), np.array(2), jnp.asarray(2)])
def test_a_whole_number_of_any_library_becomes_an_int(value):
    found = checks.whole("count", value, 2)
    assert type(found) is int
    assert found == 2


@pytest.mark.parametrize("value", [0, 1.5, -1.0, True, "0.5", None, [0.5], float("nan"), float("inf"), np.nan, 10**400])
def test_other_types_and_numbers_out_of_bounds_are_refused(value):
    with pytest.raises(InvalidArgumentError, match="share must be a finite number, above 0, at most 1, got"):
        checks.number("share", value, above=0, most=1)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf"), "a"])
def test_a_number_without_bounds_must_be_finite(value):
    assert checks.number("number", -(10**300)) == -1e300
    with pytest.raises(InvalidArgumentError, match="number must be a finite number, got"):
        checks.number("number", value)


@pytest.mark.parametrize("value", [1, 0.5, np.float32(0.5), np.array(0.5), jnp.asarray(0.5)])
def test_a_number_of_any_library_becomes_a_float_and_bounds_are_closed_or_open(value):
    assert type(checks.number("number", value)) is float
    assert checks.number("number", 1, least=1, most=1) == 1
    with pytest.raises(InvalidArgumentError, match="below 1"):
        checks.number("number", 1, below=1)


@pytest.mark.parametrize("value", [1, 0, "x", "False", None, np.ones(2, bool)])
def test_a_flag_must_be_true_or_false(value):
    assert checks.flag("switch", np.True_) is True
    with pytest.raises(InvalidArgumentError, match="switch must be True or False, got"):
        checks.flag("switch", value)


@pytest.mark.parametrize("value", ["c", None, ["a"], np.array(["a", "b"])])
def test_an_unknown_choice_is_refused_with_a_list_of_the_known_ones(value):
    checks.choice("letter", "a", ("a", "b"))
    with pytest.raises(InvalidArgumentError, match=r"letter .* is unknown: choose one of a, b"):
        checks.choice("letter", value, ("a", "b"))
