"""The registration agrees with its formulas in NumPy and moves perturbed planes back to the true one."""

import numpy as np
import pytest

from symjax.datasets import generate
from symjax.geometry.plane import Plane
from symjax.preprocess.cloud import prepare
from symjax.robust.registration import DAMPING, DISPLACEMENT_SCALE, MAX_SHIFT, MAX_TURN, Probes, grid_scores, register
from symjax.robust.search import ROUNDS
from symjax.robust.surface import estimate_surface
from symjax.robust.voxel_grid import SIZE, voxel_grid

POINT_SHARE = 0.2
SIGMA = 0.04
BATCHES = [1, 5, 16, 48, 64, 65, 100]


def scene_of(kind, num_points=2_000):
    """Returns voxel grid, probes and true plane of an object, in units of its diagonal."""
    sample = generate(kind, num_points=num_points, rng=0)
    cloud = prepare(sample.points)
    surface = estimate_surface(cloud.points)
    normal, offset = cloud.to_given.inverse().plane(Plane(*sample.planes[0]))
    rows = np.random.default_rng(1).permutation(len(cloud.points))[:512]
    probes = Probes(
        *(a.astype(np.float32) for a in (surface.points[rows], surface.normals[rows], surface.confidence[rows]))
    )
    return voxel_grid(surface, None, boundary_penalty=0.15), probes, normal, offset


@pytest.fixture(scope="module")
def scene():
    return scene_of("quadruped")


def random_planes(count):
    rng = np.random.default_rng(7)
    v = rng.normal(size=(count, 3))
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    return Plane(v.astype(np.float32), rng.uniform(-0.15, 0.15, count).astype(np.float32))


def one_step(planes, probes, grid, sigma=SIGMA):
    moved = register(planes, np.array([sigma], np.float32), probes, grid, point_weight=POINT_SHARE)
    return np.asarray(moved.normal), np.asarray(moved.offset)


def mirrored(v, omega, probes, grid):
    """Returns heights, mirror images, partners, their normals, cosines and penalties, in float64."""
    x, normals = probes.x.astype(float), probes.normals.astype(float)
    height = x @ v - omega
    image = x - 2 * np.outer(height, v)
    at = np.clip(((image - grid.origin) / float(grid.cell)).astype(int), 0, SIZE - 1)
    index = (at[:, 0] * SIZE + at[:, 1]) * SIZE + at[:, 2]
    y, n = grid.point[index].astype(float), grid.normal[index].astype(float)
    facing = normals - 2 * np.outer(normals @ v, v)
    cosine = (facing * n).sum(axis=1)
    return height, image, y, n, cosine, grid.penalty[index].astype(float)


def weight_and_agreement(v, omega, sigma, probes, grid):
    height, image, y, _, cosine, penalty = mirrored(v, omega, probes, grid)
    weight = probes.weight * (1 - np.exp(-2 * (height / (DISPLACEMENT_SCALE * sigma)) ** 2))
    return weight, np.exp(-((image - y) ** 2).sum(axis=1) / (2 * sigma**2)) * cosine**2, penalty


def step_in_numpy(v, omega, sigma, probes, grid):
    """One damped Gauss-Newton step on Σ w (n·(x′ − y))² + point_weight w ‖x′ − y‖², by finite differences."""
    weight, agreement, _ = weight_and_agreement(v, omega, sigma, probes, grid)
    _, _, y, n, _, _ = mirrored(v, omega, probes, grid)
    root = np.sqrt(weight * agreement)
    basis = np.linalg.svd(v[None])[2][1:]
    x = probes.x.astype(float)

    def residuals(t):
        u = v + t[:2] @ basis
        u = u / np.linalg.norm(u)
        off = x - 2 * np.outer(x @ u - omega - t[2], u) - y
        return np.concatenate([root * (n * off).sum(axis=1), (np.sqrt(POINT_SHARE) * root[:, None] * off).ravel()])

    jacobian = np.stack([(residuals(h) - residuals(-h)) / 2e-5 for h in 1e-5 * np.eye(3)], axis=1)
    matrix = jacobian.T @ jacobian
    matrix += (DAMPING * np.trace(matrix) / 3 + 1e-12) * np.eye(3)
    t = -np.linalg.solve(matrix, jacobian.T @ residuals(np.zeros(3)))
    turn = np.linalg.norm(t[:2])
    u = v + min(1, MAX_TURN / turn) * t[:2] @ basis
    return u / np.linalg.norm(u), omega + np.clip(t[2], -MAX_SHIFT, MAX_SHIFT)


def test_one_step_is_the_gauss_newton_step_of_the_weighted_squares(scene):
    grid, probes, *_ = scene
    planes = random_planes(64)
    v, omega = one_step(planes, probes, grid)
    expected = [step_in_numpy(a.astype(float), float(b), SIGMA, probes, grid) for a, b in zip(*planes, strict=True)]
    off = np.abs(v - np.stack([a for a, _ in expected])).max(axis=1)
    shift = np.abs(omega - np.array([b for _, b in expected]))
    # a mirror image on the border of two voxels may fall into the other one in single precision
    assert np.median(np.maximum(off, shift)) < 2e-5
    assert np.quantile(np.maximum(off, shift), 0.9) < 5e-4
    moved = np.abs(v - planes.normal).max(axis=1)
    assert np.median(moved) > 0.01


def test_a_score_is_agreement_over_agreement_and_penalty(scene):
    grid, probes, *_ = scene
    planes = random_planes(100)
    found = np.asarray(grid_scores(planes, np.float32(SIGMA), probes, grid))
    expected = []
    for v, omega in zip(*planes, strict=True):
        weight, agreement, penalty = weight_and_agreement(v.astype(float), float(omega), SIGMA, probes, grid)
        agreeing = (weight * agreement).sum()
        expected.append(agreeing / (agreeing + (weight * (1 - agreement) * penalty).sum() + 1e-6 * probes.weight.sum()))
    np.testing.assert_allclose(found, expected, atol=2e-3)
    assert np.ptp(found) > 0.1


@pytest.mark.parametrize("count", BATCHES)
def test_a_batch_gives_the_same_as_its_planes_one_by_one(scene, count):
    # jaxlib 0.10 compiles a sum over an axis of length 3 inside vmap wrongly on some CPUs, for some batch sizes
    grid, probes, *_ = scene
    planes = random_planes(count)
    alone = [one_step(Plane(*(a[i : i + 1] for a in planes)), probes, grid) for i in range(0, count, 7)]
    for order in (np.arange(count), np.arange(count)[::-1]):
        batch = Plane(*(a[order] for a in planes))
        v, omega = (a[order] for a in one_step(batch, probes, grid))
        np.testing.assert_allclose(v[::7], np.concatenate([a for a, _ in alone]), atol=2e-4)
        np.testing.assert_allclose(omega[::7], np.concatenate([b for _, b in alone]), atol=2e-4)


def test_the_result_of_a_plane_does_not_depend_on_the_rest_of_the_batch(scene):
    grid, probes, *_ = scene
    planes = random_planes(100)
    v, omega = one_step(planes, probes, grid)
    order = np.random.default_rng(0).permutation(100)
    shuffled = one_step(Plane(planes.normal[order], planes.offset[order]), probes, grid)
    np.testing.assert_allclose(shuffled[0], v[order], atol=2e-4)
    np.testing.assert_allclose(shuffled[1], omega[order], atol=2e-4)
    scores = [grid_scores(Plane(*(a[rows] for a in planes)), np.float32(SIGMA), probes, grid) for rows in (order, [3])]
    together = np.asarray(grid_scores(planes, np.float32(SIGMA), probes, grid))
    np.testing.assert_allclose(scores[0], together[order], atol=1e-3)
    np.testing.assert_allclose(scores[1], together[3:4], atol=1e-3)


def perturbed(normal, offset, count, degrees, shift):
    rng = np.random.default_rng(5)
    across = np.cross(normal, rng.normal(size=(count, 3)))
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    v = np.cos(np.radians(degrees)) * normal + np.sin(np.radians(degrees)) * across
    return Plane(v.astype(np.float32), (offset + shift * rng.choice([-1, 1], count)).astype(np.float32))


def angles(v, normal):
    return np.degrees(np.arccos(np.clip(np.abs(v.astype(float) @ normal), 0, 1)))


@pytest.mark.parametrize("kind", ["quadruped", "chair", "human", "teapot"])
def test_planes_that_are_off_by_8_degrees_and_3_per_cent_return_to_the_truth(kind):
    grid, probes, normal, offset = scene_of(kind)
    planes = perturbed(normal, offset, 64, 8.0, 0.03)
    sigmas = np.array([s for stage in ROUNDS for s in stage.sigmas], np.float32)
    moved = register(planes, sigmas, probes, grid, point_weight=ROUNDS[-1].point_weight)
    v, omega = np.asarray(moved.normal), np.asarray(moved.offset)
    assert np.quantile(angles(v, normal), 0.9) < 1.0
    assert np.quantile(np.abs(np.abs(omega) - abs(offset)), 0.9) < 0.005
    before = grid_scores(planes, np.float32(0.025), probes, grid)
    assert np.mean(np.asarray(grid_scores(moved, np.float32(0.025), probes, grid)) > np.asarray(before)) > 0.95


def test_both_orientations_of_a_plane_give_the_same(scene):
    grid, probes, *_ = scene
    planes = random_planes(64)
    turned = Plane(-planes.normal, -planes.offset)
    (v, omega), (u, tau) = (one_step(p, probes, grid) for p in (planes, turned))
    np.testing.assert_allclose(u, -v, atol=5e-4)
    np.testing.assert_allclose(tau, -omega, atol=5e-4)
    scores = [np.asarray(grid_scores(p, np.float32(SIGMA), probes, grid)) for p in (planes, turned)]
    np.testing.assert_allclose(*scores, atol=1e-3)


def test_a_step_respects_its_limits(scene):
    grid, probes, *_ = scene
    planes = random_planes(64)
    v, omega = one_step(planes, probes, grid, sigma=0.3)
    assert np.radians(angles_between(v, planes.normal)).max() <= MAX_TURN + 1e-3
    assert np.abs(omega - planes.offset).max() <= MAX_SHIFT + 1e-6
    np.testing.assert_allclose(np.linalg.norm(v, axis=1), 1.0, atol=1e-5)


def angles_between(a, b):
    return np.degrees(np.arccos(np.clip((a.astype(float) * b).sum(axis=1), -1, 1)))


def degenerate(scene, case):
    grid, probes, *_ = scene
    planes, sigma = random_planes(64), SIGMA
    if case == "no weight":
        probes = probes._replace(weight=np.zeros_like(probes.weight))
    elif case == "one place":
        probes = probes._replace(x=np.zeros_like(probes.x))
    elif case == "tiny sigma":
        sigma = 1e-6
    else:
        planes = Plane(planes.normal, planes.offset + np.float32(100))
    return planes, sigma, probes, grid


@pytest.mark.parametrize("case", ["no weight", "one place", "tiny sigma", "far away"])
def test_degenerate_input_leaves_the_plane_finite(scene, case):
    planes, sigma, probes, grid = degenerate(scene, case)
    v, omega = one_step(planes, probes, grid, sigma=sigma)
    assert np.isfinite(v).all()
    assert np.isfinite(omega).all()
    np.testing.assert_allclose(np.linalg.norm(v, axis=1), 1.0, atol=1e-5)
    if case in ("no weight", "far away"):
        np.testing.assert_allclose(v, planes.normal, atol=1e-6)


@pytest.mark.parametrize(
    "case",
    ["no weight", "one place", "tiny sigma", "far away"],
)
def test_degenerate_input_has_a_score(scene, case):
    planes, sigma, probes, grid = degenerate(scene, case)
    scores = np.asarray(grid_scores(planes, np.float32(sigma), probes, grid))
    assert ((scores >= 0) & (scores <= 1)).all()
    if case in ("no weight", "far away"):
        np.testing.assert_array_equal(scores, 0)
