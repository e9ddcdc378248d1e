"""Iterative baselines: Hruda's measure, 3DSymm, and Nagar and Raman's method."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from experiments.baselines import hruda, nagar_raman, three_d_symm
from experiments.baselines.frame import make_frame
from experiments.baselines.hruda import Hruda
from experiments.baselines.least_squares import least_squares
from experiments.baselines.nagar_raman import NagarRaman
from experiments.baselines.three_d_symm import ThreeDSymm
from experiments.data.cases import generate_case, kinds_of
from experiments.metrics.deviation import deviation
from symjax.errors import InvalidArgumentError
from symjax.geometry.plane import Plane

HALF_SPHERE = ThreeDSymm(starts="half-sphere")
METHODS = {
    "hruda": Hruda(),
    "3dsymm, pca": ThreeDSymm(),
    "3dsymm, half-sphere": replace(HALF_SPHERE, max_points=500),
    "nagar-raman": NagarRaman(max_points=200),
}
TEN = kinds_of("single", 10)


def drawn():
    return np.random.default_rng(0)


def angle(a, b):
    return np.degrees(np.arccos(min(1.0, abs(a @ b))))


def tilted(normal, degrees, rng):
    across = np.cross(normal, rng.normal(size=3))
    return np.cos(np.radians(degrees)) * normal + np.sin(np.radians(degrees)) * across / np.linalg.norm(across)


def mirrored(num, rng, *, spread=(0.6, 1.5, 1.0)):
    """Points and their exact mirror images, and the plane, which is oblique to the coordinate axes."""
    normal = np.array([0.36, 0.48, 0.8])
    half = rng.normal(size=(num, 3)) * spread
    half += np.outer(0.7 - half @ normal + np.abs(half @ normal), normal)
    return np.vstack([half, Plane(normal, np.array(0.7)).reflect(half)]), Plane(normal, np.array(0.7))


def within_five_degrees(method, kind, num_points):
    case = generate_case(kind, num_points, 0)
    return deviation(method.rank(case.points, drawn()).plane(), case).angle < 5


@pytest.mark.slow
def test_hruda_finds_the_plane_of_clean_objects():
    assert np.mean([within_five_degrees(Hruda(), kind, 1500) for kind in TEN]) >= 0.9


def test_3dsymm_finds_the_plane_of_clean_objects():
    assert np.mean([within_five_degrees(ThreeDSymm(), kind, 1500) for kind in TEN]) >= 0.9


@pytest.mark.slow
def test_3dsymm_finds_the_plane_of_clean_objects_from_26_starts():
    assert np.mean([within_five_degrees(HALF_SPHERE, kind, 400) for kind in TEN]) >= 0.9


@pytest.mark.slow
def test_nagar_raman_finds_the_plane_of_clean_objects():
    assert np.mean([within_five_degrees(NagarRaman(), kind, 1500) for kind in TEN]) >= 0.9


@pytest.mark.parametrize("name", METHODS)
def test_an_exact_mirror_plane_is_found(name, rng):
    points, plane = mirrored(100, rng)
    ranking = METHODS[name].rank(points, drawn())
    # the maximum of a smooth measure is only as exact as the optimiser's tolerance
    assert angle(ranking.normals[0], plane.normal) < (0.05 if name == "hruda" else 1e-5)
    assert abs(abs(ranking.offsets[0]) - 0.7) < (1e-3 if name == "hruda" else 1e-8)


@pytest.mark.parametrize("name", METHODS)
def test_planes_are_distinct_and_ranked(name):
    case = generate_case("quadruped", 600, 0)
    ranking = METHODS[name].rank(case.points, drawn())
    assert (np.diff(ranking.scores) <= 0).all()
    np.testing.assert_allclose(np.linalg.norm(ranking.normals, axis=1), 1)
    apart = [angle(a, b) for k, a in enumerate(ranking.normals) for b in ranking.normals[:k]]
    assert min(apart, default=90) > 3
    again = METHODS[name].rank(case.points, drawn())
    np.testing.assert_array_equal(again.normals, ranking.normals)


@pytest.mark.parametrize(("name", "degrees"), [("hruda", 1), ("3dsymm, pca", 1e-4), ("3dsymm, half-sphere", 1)])
def test_the_plane_moves_with_the_cloud(name, degrees, rng):
    # Hruda's grid and the 26 directions do not turn with the cloud
    points = generate_case("quadruped", 500, 0).points
    turn, shift = np.linalg.qr(rng.normal(size=(3, 3)))[0], 10 * rng.normal(size=3)
    plane = METHODS[name].rank(points, drawn()).plane()
    moved = METHODS[name].rank(30 * points @ turn.T + shift, drawn()).plane()
    assert angle(moved.normal, turn @ plane.normal) < degrees
    centre = points.mean(axis=0)
    before, after = plane.signed_distance(centre[None]), moved.signed_distance((30 * turn @ centre + shift)[None])
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    assert abs(abs(after[0]) / 30 - abs(before[0])) < 1e-2 * degrees * diagonal


def test_hruda_kernel_is_nearly_a_gaussian_of_finite_support():
    distance = np.linspace(0, 0.3, 1001)
    value = hruda.kernel(distance[:, None] * np.array([0.6, 0, 0.8]), 15.0)
    assert np.abs(value - np.exp(-((15 * distance) ** 2))).max() < 0.02
    assert value[0] == 1
    assert (np.diff(value) <= 0).all()
    assert (value[15 * distance > 2.6] == 0).all()


@pytest.mark.parametrize("far", [[], [[60.0, -40.0, 5.0]]], ids=["compact", "with a point far away"])
def test_hruda_measure_is_the_sum_over_all_pairs(far, rng):
    points = np.vstack([rng.normal(size=(200, 3)), np.reshape(far, (-1, 3))])
    planes = rng.normal(size=(100, 4))
    planes[:, :3] /= np.linalg.norm(planes[:, :3], axis=1, keepdims=True)
    expected = []
    for plane in planes:
        distance = cdist(Plane(plane[:3], plane[3]).reflect(points), points).ravel()
        expected.append(hruda.kernel(distance[:, None] * np.eye(3)[0], 5.0).sum())
    np.testing.assert_allclose(hruda.measure(hruda.cell_lists(points, 5.0), planes), expected, rtol=1e-10, atol=1e-12)


def test_hruda_gradient_is_that_of_central_differences(rng):
    grid = hruda.cell_lists(rng.normal(size=(150, 3)), 5.0)
    for z in rng.normal(size=(10, 4)):
        value, gradient = hruda.measure_and_gradient(grid, z)
        assert value == pytest.approx(hruda.measure(grid, z[None] / np.linalg.norm(z[:3]))[0], rel=1e-12)
        steps = 1e-5 * np.eye(4)
        slopes = [
            hruda.measure_and_gradient(grid, z + h)[0] - hruda.measure_and_gradient(grid, z - h)[0] for h in steps
        ]
        np.testing.assert_allclose(gradient, np.array(slopes) / 2e-5, atol=1e-5 * np.abs(gradient).max())
        # the measure does not change along z: multiples are the same plane
        assert abs(gradient @ z) < 1e-9 * np.abs(gradient).max()


def test_hruda_maximisation_ends_at_a_higher_stationary_point(rng):
    points, plane = mirrored(200, rng)
    grid = hruda.cell_lists(points, 5.0)
    start = np.append(tilted(plane.normal, 5, rng), plane.offset + 0.05)
    end = hruda.maximise(grid, start)
    low, high = hruda.measure(grid, np.stack([start, end]))
    assert high > 1.2 * low
    assert np.abs(hruda.measure_and_gradient(grid, end)[1]).max() < 1e-4 * high


def test_hruda_averages_to_about_the_requested_number(rng):
    points = rng.normal(size=(5000, 3))
    for number in (100, 1000):
        means = hruda.grid_means(points, number)
        assert 0.85 * number < len(means) <= number
        assert (np.abs(means) <= np.abs(points).max(axis=0)).all()
    np.testing.assert_array_equal(hruda.grid_means(points[:50], 100), points[:50])


def test_hruda_candidates_lie_halfway_and_close_ones_are_averaged():
    two = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 2.0]])
    np.testing.assert_allclose(hruda.candidates(two, drawn(), 0.1), [[0, 0, 1, 1]])
    # planes with opposite signs are averaged too
    near = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0], [0.0, 0.05, -1.0]])
    planes = hruda.candidates(near, drawn(), 0.1)
    assert len(planes) == 2
    assert np.abs(planes[:, 2]).max() == pytest.approx(np.cos(np.arctan(0.025) / 2), rel=1e-4)


@pytest.mark.slow
def test_hruda_returns_all_planes_of_a_box_and_none_below_the_share(rng):
    corner = rng.uniform(size=(60, 3))
    corner[np.arange(60), np.arange(60) % 3] = 1
    signs = np.stack(np.meshgrid(*[[-1, 1]] * 3), axis=-1).reshape(-1, 1, 3)
    box = (corner * signs * [1.0, 1.3, 1.7]).reshape(-1, 3)
    everything = Hruda(starts=40, share=0.0).rank(box, drawn())
    ranking = Hruda(starts=40).rank(box, drawn())
    assert len(ranking.scores) == (everything.scores >= 0.7 * everything.scores[0]).sum() < len(everything.scores)
    np.testing.assert_allclose(ranking.scores, 1, atol=1e-3)
    np.testing.assert_allclose(np.sort(np.abs(ranking.normals), axis=0), np.sort(np.eye(3), axis=0), atol=1e-2)


@pytest.mark.parametrize("matched", [three_d_symm.nearest, nagar_raman.assignment])
def test_no_step_increases_the_cost(matched, rng):
    points = make_frame(generate_case("bird", 200, 0).points, rng).points
    match = matched(points)
    normal, offset = rng.normal(size=3), 0.1
    plane = normal / np.linalg.norm(normal), offset
    costs = [three_d_symm.residual(points, *plane, match)]
    for _ in range(15):
        plane = three_d_symm.alternate(points, *plane, match, max_steps=1)
        costs.append(three_d_symm.residual(points, *plane, match))
    assert (np.diff(costs) <= 1e-12).all()
    assert costs[-1] < costs[0]


def test_3dsymm_returns_from_10_degrees_and_not_from_60(rng):
    # the paper reports this with a limit of 20 degrees; here it holds for most objects, with a limit of 20 to 40
    back = {10: [], 60: []}
    for kind in TEN:
        case = generate_case(kind, 500, 0)
        frame = make_frame(case.points, rng)
        match = three_d_symm.nearest(frame.points)
        for degrees, right in back.items():
            start = tilted(case.planes[0].normal, degrees, rng)
            end, _ = three_d_symm.alternate(frame.points, start, 0.0, match)
            right.append(angle(end, case.planes[0].normal) < 5)
    assert np.mean(back[10]) >= 0.9
    assert np.mean(back[60]) <= 0.3


def test_every_direction_is_near_one_of_the_26(rng):
    directions = three_d_symm.half_sphere()
    assert directions.shape == (26, 3)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, rtol=1e-6)
    others = rng.normal(size=(20_000, 3))
    others /= np.linalg.norm(others, axis=1, keepdims=True)
    assert np.abs(others @ directions.T).max(axis=1).min() > np.cos(np.radians(23.5))


def test_an_unknown_start_is_refused(rng):
    with pytest.raises(InvalidArgumentError, match="starts 'sphere' is unknown: choose one of pca, half-sphere"):
        ThreeDSymm(starts="sphere").rank(rng.normal(size=(50, 3)), rng)


def test_assignment_is_one_to_one_and_keeps_the_plane_in_the_mean(rng):
    points = rng.normal(size=(80, 3))
    partners = nagar_raman.assignment(points)(Plane(np.array([0.0, 0.6, 0.8]), np.array(0.3)).reflect(points))
    np.testing.assert_array_equal(np.sort(partners, axis=0), np.sort(points, axis=0))
    normal, offset = least_squares(points, partners)
    assert normal @ points.mean(axis=0) == pytest.approx(offset, abs=1e-12)


def test_planes_of_nagar_raman_pass_through_the_mean_of_all_points(rng):
    points = rng.normal(size=(600, 3)) + [0.0, 5.0, 0.0]
    ranking = NagarRaman(max_points=60).rank(points, drawn())
    np.testing.assert_allclose(ranking.normals @ points.mean(axis=0), ranking.offsets, atol=1e-12)
