"""Arrays on a device are checked there, and raise the same errors as arrays on the host."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError, NonfiniteError, SymjaxError
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.pairs import arguments, padded

SIGMA = 0.02


class HostNumPy:
    """NumPy whose functions refuse JAX arrays of more than three numbers, which they would copy to the host."""

    def __getattr__(self, name):
        found = getattr(np, name)
        if isinstance(found, type) or not callable(found):
            return found

        def guarded(*args, **kwargs):
            for leaf in jax.tree.leaves((args, kwargs)):
                assert not (isinstance(leaf, jax.Array) and leaf.size > 3), f"np.{name} copies {leaf.shape}"
            return found(*args, **kwargs)

        return guarded


@pytest.fixture
def on_device(monkeypatch):
    """Makes JAX arrays count as arrays on a device other than the CPU, and forbids copying them."""
    monkeypatch.setattr(
        arguments, "_on_device", lambda a: isinstance(a, jax.Array) and not isinstance(a, jax.core.Tracer)
    )
    for module in (arguments, padded):
        monkeypatch.setattr(module, "np", HostNumPy())


@pytest.fixture(scope="module")
def pairs():
    return planted_pairs(np.random.default_rng(2), 60, 0.5)


@pytest.mark.usefixtures("on_device")
def test_pairs_on_a_device_are_not_copied_to_be_checked(pairs):
    x, y, v0 = (jnp.asarray(array) for array in (pairs.x, pairs.y, pairs.normal))
    weights = jnp.ones(60)
    fit = fit_plane(x, y, SIGMA, v0, weights=weights)
    assert fit.converged
    np.testing.assert_allclose(fit.plane.normal, fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal).plane.normal)


WRONG = {
    "nonfinite": {"x": lambda x: x.at[5, 1].set(jnp.nan).at[7].set(jnp.inf)},
    "weights": {"weights": lambda w: w.at[3].set(-1.0)},
    "zero": {"weights": lambda w: 0 * w},
    "v0": {"v0": lambda v: 1.5 * v},
}


def refused(given, wrong, convert):
    with pytest.raises(SymjaxError) as error:
        fit_plane(**{name: convert(wrong.get(name, lambda a: a)(array)) for name, array in given.items()}, sigma=SIGMA)
    return type(error.value), str(error.value)


@pytest.mark.parametrize("name", WRONG)
def test_a_device_array_raises_the_error_of_a_host_array(pairs, name, request):
    given = {"x": jnp.asarray(pairs.x), "y": jnp.asarray(pairs.y), "weights": jnp.ones(60), "v0": jnp.eye(3)[0]}
    expected = refused(given, WRONG[name], np.asarray)
    request.getfixturevalue("on_device")
    assert refused(given, WRONG[name], lambda array: array) == expected
    assert expected[0] in (NonfiniteError, InvalidArgumentError)
