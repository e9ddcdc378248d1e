"""Heat kernel signatures: scale invariance, symmetry, the range of times, and whitening."""

import numpy as np
import pytest

from symjax.errors import InvalidArgumentError
from symjax.symhks.signatures import diffusion_times, heat_kernel_signatures, sign_vectors, whiten
from symjax.symhks.spectrum import Spectrum, spectrum


def ellipsoid(rng, num_points=1_500):
    points = rng.normal(size=(num_points, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True) * [1.0, 1.4, 2.0]


def test_signatures_are_scale_invariant(rng):
    points = ellipsoid(rng)
    small, large = spectrum(points), spectrum(1e3 * points)
    np.testing.assert_allclose(
        heat_kernel_signatures(large, diffusion_times(large)),
        heat_kernel_signatures(small, diffusion_times(small)),
        rtol=1e-6,
    )


def test_exact_mirror_images_have_equal_signatures_and_different_signs(rng):
    half = ellipsoid(rng)
    half = half[np.abs(half[:, 0]) > 0.02]
    points = np.concatenate([half, half * [-1.0, 1.0, 1.0]])
    eigen = spectrum(points)
    signatures = heat_kernel_signatures(eigen, diffusion_times(eigen))
    np.testing.assert_allclose(signatures[: len(half)], signatures[len(half) :], rtol=2e-3)
    signs = sign_vectors(eigen, np.arange(len(points)))
    assert (signs[: len(half)] != signs[len(half) :]).any(axis=1).all()


def test_signatures_are_the_diagonal_of_the_heat_kernel():
    eigen = Spectrum(np.array([0.0, 2.0]), np.array([[0.5, 1.0], [0.5, -3.0]]), np.array([2.0, 2.0]))
    expected = 4.0 * np.array([[0.25 + np.exp(-2.0)], [0.25 + 9 * np.exp(-2.0)]])
    np.testing.assert_allclose(heat_kernel_signatures(eigen, np.array([1.0])), expected)


@pytest.mark.parametrize("scale", ["logarithmic", "uniform"])
def test_times_are_finite_for_a_cloud_of_two_components(rng, scale):
    piece = ellipsoid(rng, 700)
    one, two = spectrum(piece), spectrum(np.concatenate([piece, piece + [9.0, 0.0, 0.0]]))
    longest = diffusion_times(one, scale=scale)[-1]
    assert diffusion_times(two, scale=scale)[-1] == pytest.approx(longest, rel=0.05)


def test_times_span_the_printed_ranges():
    eigen = Spectrum(np.array([0.0, 2.0, 8.0]), np.ones((4, 3)), np.ones(4))
    uniform = diffusion_times(eigen, num_times=5, scale="uniform")
    np.testing.assert_allclose(uniform[[0, -1]], 10 * np.log(10) / np.array([8.0, 2.0]))
    np.testing.assert_allclose(np.diff(uniform), np.diff(uniform)[0])
    logarithmic = diffusion_times(eigen, num_times=5)
    np.testing.assert_allclose(logarithmic[[0, -1]], 4 * np.log(10) / np.array([8.0, 2.0]))
    np.testing.assert_allclose(np.diff(np.log(logarithmic)), np.log(4) / 4)
    with pytest.raises(InvalidArgumentError, match="linear"):
        diffusion_times(eigen, scale="linear")  # type: ignore[arg-type]


def test_whitened_distances_are_mahalanobis_distances(rng):
    reference = rng.normal(size=(500, 3)) @ rng.normal(size=(3, 3))
    white = whiten(reference, reference)
    np.testing.assert_allclose(white.T @ white / 500, np.eye(3), atol=1e-9)
    step = reference[0] - reference[1]
    expected = step @ np.linalg.solve(np.cov(reference.T, bias=True), step)
    assert ((white[0] - white[1]) ** 2).sum() == pytest.approx(expected, rel=1e-9)
