import jaxtyping
import numpy as np
import pytest

from symjax.datasets.corruption import add_outliers


def test_every_annotation_of_symjax_is_checked():
    assert add_outliers(np.zeros((9, 3)), 1).shape == (18, 3)
    try:
        add_outliers(np.zeros((9, 4)), 1.0)
    except jaxtyping.TypeCheckError as error:  # `pytest.raises` switches the checks off
        message = str(error)
    else:
        pytest.fail("a wrong shape was accepted")
    assert "Float[ndarray, 'n 3']" in message


def test_inside_pytest_raises_a_wrong_argument_raises_the_error_that_users_see():
    with pytest.raises(TypeError, match="'>=' not supported"):
        add_outliers(np.zeros((9, 3)), "a")
    assert not jaxtyping.config.jaxtyping_disable
