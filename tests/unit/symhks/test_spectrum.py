"""The Laplacian: known values on the sphere and the plane, and invariances."""

import numpy as np
import pytest
from scipy.spatial import Delaunay, cKDTree

from symjax.errors import InvalidArgumentError, SpectrumError
from symjax.symhks.spectrum import delaunay_stars, spectrum, star_laplacian


def sphere(rng, num_points):
    points = rng.normal(size=(num_points, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


@pytest.mark.parametrize("num_points", [1_000, 5_000, 20_000])
def test_the_unit_sphere_has_its_area_and_first_eigenvalue_at_every_density(rng, num_points):
    eigen = spectrum(sphere(rng, num_points), num_eigs=10)
    assert eigen.area == pytest.approx(4 * np.pi, rel=0.02)
    # l(l + 1) = 2, three times, then 6, five times
    np.testing.assert_allclose(eigen.eigenvalues[1:4], 2.0, rtol=0.08)
    np.testing.assert_allclose(eigen.eigenvalues[4:9], 6.0, rtol=0.10)


def test_the_first_eigenfunctions_of_the_sphere_are_its_coordinates(rng):
    points = sphere(rng, 3_000)
    eigen = spectrum(points, num_eigs=4)
    first = eigen.eigenfunctions[:, 1:]
    projected = first @ (first.T @ (eigen.mass[:, None] * points))
    assert np.abs(projected - points).max() < 0.1


@pytest.mark.parametrize("change", ["rotation", "reflection", "permutation", "shift", "scale"])
def test_the_spectrum_depends_only_on_the_surface(rng, change):
    points = sphere(rng, 2_000) * [1.0, 1.5, 2.0]
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    moved, scale = {
        "rotation": (points @ turn.T, 1.0),
        "reflection": (points @ (turn @ np.diag([-1.0, 1.0, 1.0])).T, 1.0),
        "permutation": (points[rng.permutation(len(points))], 1.0),
        "shift": (points + 1e6, 1.0),
        "scale": (points * 1e3, 1e3),
    }[change]
    before, after = spectrum(points), spectrum(moved)
    np.testing.assert_allclose(after.eigenvalues[1:] * scale**2, before.eigenvalues[1:], rtol=1e-3)
    assert after.area == pytest.approx(before.area * scale**2, rel=1e-3)


def test_eigenpairs_solve_the_generalised_problem_and_are_orthonormal(rng):
    points = sphere(rng, 1_500) * [1.0, 1.5, 2.0]
    matrix, _ = star_laplacian(points)
    eigen = spectrum(points)
    left = matrix @ eigen.eigenfunctions
    right = eigen.mass[:, None] * eigen.eigenfunctions * eigen.eigenvalues
    assert np.abs(left - right).max() < 1e-8 * np.abs(right).max()
    gram = eigen.eigenfunctions.T @ (eigen.mass[:, None] * eigen.eigenfunctions)
    np.testing.assert_allclose(gram, np.eye(20), atol=1e-9)


def test_stars_are_those_of_the_delaunay_triangulation(rng):
    flat = np.c_[rng.uniform(size=(400, 2)), np.zeros(400)]
    neighbours = cKDTree(flat).query(flat, k=31)[1][:, 1:]
    stars = delaunay_stars(flat, neighbours, normals=np.tile([0.0, 0.0, 1.0], (400, 1)))
    inside = (np.abs(flat[:, :2] - 0.5) < 0.3).all(axis=1)
    ours = {(row[0], *sorted(row[1:])) for row in stars.tolist() if inside[row[0]]}
    whole = Delaunay(flat[:, :2]).simplices
    theirs = {
        (a, *sorted((b, c)))
        for row in whole.tolist()
        for a, b, c in ((row[0], row[1], row[2]), (row[1], row[0], row[2]), (row[2], row[0], row[1]))
        if inside[a]
    }
    assert ours == theirs


def test_given_normals_may_have_any_length_and_sign(rng):
    points = sphere(rng, 3_000)
    eigen = spectrum(points, normals=-3.0 * points, num_eigs=5)
    np.testing.assert_allclose(eigen.eigenvalues[1:4], 2.0, rtol=0.08)


def test_every_connected_component_has_a_zero_eigenvalue(rng):
    piece = sphere(rng, 800)
    eigen = spectrum(np.concatenate([piece, piece + [5.0, 0.0, 0.0]]), num_eigs=6)
    assert eigen.num_components == 2


def test_too_many_eigenpairs_and_a_line_are_refused(rng):
    with pytest.raises(InvalidArgumentError, match="num_eigs"):
        spectrum(sphere(rng, 60), num_eigs=60)
    with pytest.raises(SpectrumError):
        spectrum(np.outer(np.linspace(0, 1, 100), [1.0, 0.0, 0.0]))


def test_repeated_runs_agree_bit_for_bit(rng):
    points = sphere(rng, 1_000)
    np.testing.assert_array_equal(spectrum(points).eigenfunctions, spectrum(points).eigenfunctions)
