"""Eigenvalues by Jacobi rotations are those of LAPACK, for difficult matrices too."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.l2e.solvers import small_eigh

eigh = jax.jit(jax.vmap(small_eigh.eigh))


def symmetric(rng, num, size):
    A = rng.normal(size=(num, size, size))
    return A + A.swapaxes(1, 2)


def hard(rng):
    """3 × 3 matrices with equal, zero, nearly equal and widely different eigenvalues, large and small."""
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    spectra = [[1, 1, 1], [2, 2, -1], [0, 0, 1], [1, 1 + 1e-12, -1], [1, 1e-9, -1e-9], [-3, -2, -1]]
    turned = [frame @ np.diag(values) @ frame.T for values in spectra]
    plain = [np.zeros((3, 3)), np.eye(3), np.diag([3.0, -1, 2]), np.ones((3, 3)), np.eye(3)[::-1], -turned[1]]
    tiny_off_diagonal = np.diag([1.0, 1, 2]) + 1e-300 * np.ones((3, 3))
    graded = np.diag([1e12, 1.0, 1e-12]) + 1e-14 * np.ones((3, 3))
    rest = symmetric(rng, 200, 3)
    return np.stack([*turned, *plain, tiny_off_diagonal, graded, *rest, *1e-150 * rest[:5], *1e150 * rest[:5]])


def check(matrices, values, vectors, eps):
    """Eigenvalues are LAPACK's; the eigenvectors are orthonormal and diagonalise."""
    size = matrices.shape[1]
    scale = np.abs(matrices).max(axis=(1, 2))
    scale = np.where(scale > 0, scale, 1)
    unit = matrices / scale[:, None, None]
    values = np.asarray(values) / scale[:, None]
    expected = np.linalg.eigvalsh(unit.astype(float))
    np.testing.assert_allclose(np.sort(values, axis=1), expected, atol=20 * size * eps)
    vectors = np.asarray(vectors)
    orthonormal = np.broadcast_to(np.eye(size), matrices.shape)
    np.testing.assert_allclose(vectors.swapaxes(1, 2) @ vectors, orthonormal, atol=20 * size * eps)
    np.testing.assert_allclose(unit @ vectors, vectors * values[:, None, :], atol=40 * size * eps)


def test_hard_matrices(rng):
    matrices = hard(rng)
    check(matrices, *eigh(jnp.asarray(matrices)), np.finfo(float).eps)


@pytest.mark.parametrize("size", [1, 2, 4, 5])
def test_other_sizes(rng, size):
    matrices = symmetric(rng, 50, size)
    check(matrices, *eigh(jnp.asarray(matrices)), np.finfo(float).eps)


@pytest.mark.any_precision
def test_float32(rng):
    single = symmetric(rng, 500, 3).astype(np.float32)
    values, vectors = eigh(jnp.asarray(single))
    assert values.dtype == vectors.dtype == jnp.float32
    check(single, values, vectors, np.finfo(np.float32).eps)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("num", [2, 3, 8, 64])
def test_a_batch_is_its_matrices_one_by_one(rng, dtype, num):
    matrices = jnp.asarray(symmetric(rng, num, 3), dtype)
    alone = jax.jit(small_eigh.eigh)
    for k, (values, vectors) in enumerate(zip(*eigh(matrices), strict=True)):
        expected = alone(matrices[k])
        np.testing.assert_allclose(values, expected[0], atol=20 * np.finfo(dtype).eps)
        np.testing.assert_allclose(vectors, expected[1], atol=20 * np.finfo(dtype).eps)


def test_the_worst_of_many_is_diagonal_to_rounding(rng):
    matrices = symmetric(rng, 20_000, 3)
    check(matrices, *eigh(jnp.asarray(matrices)), np.finfo(float).eps)


def test_a_nan_matrix_gives_nan_and_does_not_affect_the_others(rng):
    matrices = symmetric(rng, 2, 3)
    matrices[0, 1, 1] = np.nan
    values, vectors = eigh(jnp.asarray(matrices))
    assert np.isnan(values[0]).any()
    check(matrices[1:], values[1:], vectors[1:], np.finfo(float).eps)
