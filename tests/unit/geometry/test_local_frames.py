"""Local frames are orthonormal, and their normals are those of the surface."""

import numpy as np

from symjax.geometry.local_frames import local_frames, tangent_frames


def test_tangent_frames_are_orthonormal(rng):
    normals = np.concatenate([rng.normal(size=(100, 3)), np.eye(3), -np.eye(3)])
    frames = tangent_frames(normals)
    np.testing.assert_allclose(np.einsum("nij,nik->njk", frames, frames), np.tile(np.eye(2), (106, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.einsum("nij,ni->nj", frames, normals), 0.0, atol=1e-12)
    np.testing.assert_array_equal([tangent_frames(normal) for normal in normals], frames)


def test_neighbours_on_a_plane_have_its_normal_and_no_variance_along_it(rng):
    normal = np.array([0.6, 0.0, 0.8])
    points = rng.normal(size=(30, 2)) @ tangent_frames(normal).T + 5 * normal
    neighbours = rng.integers(30, size=(7, 12))
    variance, axes = local_frames(points, neighbours)
    np.testing.assert_allclose(variance[:, 0], 0.0, atol=1e-12)
    np.testing.assert_allclose(np.abs(axes[:, :, 0] @ normal), 1.0, atol=1e-9)
    spread = points[neighbours] - points[neighbours].mean(axis=1, keepdims=True)
    np.testing.assert_allclose(variance.sum(axis=1), (spread**2).sum(axis=2).mean(axis=1))
