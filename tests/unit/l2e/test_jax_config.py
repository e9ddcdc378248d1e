"""float64 pairs are fitted in float64 under any flags, traced pairs keep their type; and the compilation cache."""

import os
import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.errors import InvalidArgumentError
from symjax.l2e.fit import best
from symjax.l2e.fit_global import fit_global
from symjax.l2e.fit_plane import fit_plane
from symjax.l2e.jax_config import enable_compilation_cache
from symjax.l2e.objective import l2e_loss
from symjax.l2e.standard_errors import standard_errors
from symjax.l2e.sweep import sweep, sweep_clouds

SIGMA = 0.02
EPS = np.finfo(np.float64).eps

PROGRAM = """
import sys, numpy as np, jax, symjax
counts = []
jax.monitoring.register_event_listener(lambda event, **_: counts.append(event))
folder = symjax.enable_compilation_cache(sys.argv[1] if len(sys.argv) > 1 else None)
rng = np.random.default_rng(0)
x = rng.normal(size=(50, 3))
symjax.fit_plane(x, x * [-1, 1, 1], 0.1, [1.0, 0.0, 0.0])
print(folder, counts.count("/jax/compilation_cache/cache_hits"), counts.count("/jax/compilation_cache/cache_misses"))
"""


@pytest.fixture
def pairs():
    return planted_pairs(np.random.default_rng(2), 60, 0.5)


@pytest.fixture(autouse=True)
def default_flags():
    with jax.enable_x64(False):
        yield


def is_double(fit):
    """Whether all floating leaves of a fit are float64, and stay so in the next operation."""
    leaves = [leaf for leaf in jax.tree.leaves(fit) if np.issubdtype(leaf.dtype, np.floating)]
    return len(leaves) >= 8 and all((2 * leaf).dtype == np.float64 for leaf in leaves)


@pytest.mark.any_precision
@pytest.mark.parametrize("given", [lambda points: points, lambda points: points.tolist()], ids=["array", "list"])
def test_a_fit_of_float64_pairs_is_float64(pairs, given):
    fit = fit_plane(given(pairs.x), given(pairs.y), SIGMA, pairs.normal, tol=1e-12)
    assert is_double(fit)
    assert fit.converged
    assert fit.grad_norm <= 1e-12
    assert fit.message.startswith("Converged")


def test_it_is_the_fit_under_x64(pairs):
    fit = fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal)
    with jax.enable_x64(True):
        expected = fit_plane(pairs.x, pairs.y, SIGMA, pairs.normal)
    for a, b in zip(jax.tree.leaves(fit), jax.tree.leaves(expected), strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.any_precision
def test_so_is_the_loss_of_a_plane(pairs):
    x, y = pairs.x, pairs.y
    with jax.enable_x64(True):
        expected = l2e_loss(pairs.normal, pairs.offset, SIGMA, x, y)
    loss = l2e_loss(pairs.normal, pairs.offset, SIGMA, x, y)
    assert loss.dtype == np.float64
    np.testing.assert_array_equal(loss, expected)
    single = l2e_loss(*(jnp.float32(part) for part in (pairs.normal, pairs.offset, SIGMA, x, y)))
    assert isinstance(single, jax.Array)
    assert single.dtype == jnp.float32


@pytest.mark.slow
@pytest.mark.any_precision
def test_so_is_every_other_function_of_pairs(pairs):
    for sigma in (SIGMA, "auto"):
        fit = fit_global(pairs.x, pairs.y, sigma, num_hypotheses=64, num_refined=4)
        assert is_double(fit)
        assert fit.grad_norm < 1e-9
    errors = standard_errors(fit, pairs.x, pairs.y)
    assert errors.plane.covariance.dtype == np.float64
    # unsymmetric by the rounding of float64, not of float32
    covariance = errors.plane.covariance
    assert np.abs(covariance - covariance.T).max() < 1e4 * EPS * np.abs(covariance).max()
    fits = sweep(pairs.x, pairs.y, [SIGMA, 0.1], restarts=4)
    assert is_double(fits)
    assert is_double(best(fits))
    assert best(fits).converged.all()
    assert is_double(sweep_clouds([(pairs.x, pairs.y)] * 2, [SIGMA, 0.1], restarts=4))


@pytest.mark.slow
@pytest.mark.any_precision
def test_float32_jax_arrays_and_traced_pairs_keep_their_type(pairs):
    x, y = np.float32(pairs.x), np.float32(pairs.y)
    fits = [
        fit_plane(x, y, SIGMA),
        fit_plane(jnp.asarray(pairs.x), jnp.asarray(pairs.y), SIGMA),
        jax.jit(lambda x: fit_plane(x, pairs.y, SIGMA))(pairs.x),
        jax.jit(lambda: fit_plane(pairs.x, pairs.y, SIGMA))(),
        jax.jit(lambda sigma: fit_plane(pairs.x, pairs.y, sigma))(SIGMA),
    ]
    for fit in fits:
        assert isinstance(fit.loss, jax.Array)
        assert fit.loss.dtype == fit.plane.normal.dtype == jnp.float32
    assert jax.grad(lambda sigma: fit_plane(pairs.x, pairs.y, sigma).loss)(SIGMA).dtype == jnp.float32


def run(*arguments, **environment):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | environment,
    )
    folder, hits, misses = done.stdout.split()
    return folder, int(hits), int(misses)


def test_a_process_loads_what_an_earlier_one_compiled(tmp_path):
    folder = tmp_path / "cache"
    _, hits, misses = run(str(folder))
    assert hits == 0
    assert misses > 0
    assert any(folder.iterdir())
    assert run(str(folder)) == (str(folder), misses, 0)


@pytest.mark.slow
def test_the_folder_is_that_of_the_environment(tmp_path):
    folder, _, _ = run(SYMJAX_CACHE=str(tmp_path / "named"))
    assert folder == str(tmp_path / "named")
    assert any((tmp_path / "named").iterdir())


def test_a_folder_that_cannot_be_created_is_an_error_of_symjax(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InvalidArgumentError, match="cannot create the folder"):
        enable_compilation_cache(tmp_path / "file" / "cache")
