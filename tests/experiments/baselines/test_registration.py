"""Baselines that compare a cloud with its mirror image: a descriptor on a grid, and registration."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from experiments.baselines import cicconet, kazhdan
from experiments.baselines.cicconet import Cicconet, Registration, plane_of_composition, register, rigid_motion
from experiments.baselines.kazhdan import Kazhdan
from experiments.data.cases import generate_case, kinds_of
from experiments.metrics.deviation import deviation
from experiments.metrics.ranking import plane_distance
from symjax.geometry.plane import Plane

KINDS = kinds_of("single", 10)
METHODS = {"kazhdan's grid": Kazhdan(refine=False), "kazhdan": Kazhdan(), "cicconet": Cicconet()}
COARSE = Kazhdan(num_normals=400, resolution=32)
"""For tests that a degree more or less does not matter to."""


@pytest.fixture(scope="module")
def quadruped():
    return generate_case("quadruped", 1500, 1)


def turned(rng):
    """A random orthogonal matrix, rotation or reflection."""
    return np.linalg.qr(rng.normal(size=(3, 3)))[0]


def mirrored(rng, normal, offset, half=400):
    """An asymmetric cloud and its mirror image."""
    one = rng.gamma(2.0, size=(half, 3)) * (1.0, 0.6, 0.3)
    return np.concatenate([one, Plane(normal, offset).reflect(one)])


def unit(rng):
    v = rng.normal(size=3)
    return v / np.linalg.norm(v)


def box(rng, num_points=3000):
    """The surface of a box of sides 6, 4 and 2."""
    points = rng.uniform(-1, 1, size=(num_points, 3))
    face = rng.choice(3, size=num_points, p=np.array([4 * 2, 6 * 2, 6 * 4]) / 44)
    points[np.arange(num_points), face] = rng.choice([-1, 1], size=num_points)
    return points * (3, 2, 1)


@pytest.mark.slow
@pytest.mark.parametrize(("method", "least"), [("kazhdan's grid", 0.8), ("kazhdan", 0.9), ("cicconet", 0.9)])
def test_planes_of_clean_clouds_are_right(method, least):
    cases = [generate_case(kind, 1500, 0) for kind in KINDS]
    found = [deviation(METHODS[method].rank(case.points, np.random.default_rng(0)).plane(), case) for case in cases]
    assert np.mean([off.angle < 5 for off in found]) >= least
    assert np.mean([off.correct for off in found]) >= least


@pytest.mark.parametrize(("method", "degrees"), [("kazhdan's grid", 3.0), ("kazhdan", 0.5), ("cicconet", 1e-5)])
def test_an_exact_mirror_is_found(method, degrees, rng):
    planted = Plane(unit(rng), np.float64(0.7))
    points = mirrored(rng, planted.normal, 0.7)
    found = METHODS[method].rank(points, rng).plane()
    assert found.angle(planted) < degrees
    # the planted and the found plane pass through the mean
    assert abs(found.signed_distance(points.mean(axis=0)[None])[0]) < 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_scores_decrease_and_normals_are_unit_vectors(method, quadruped, rng):
    found = METHODS[method].rank(quadruped.points, rng)
    assert len(found.normals) == len(found.offsets) == len(found.scores) >= 3
    assert (np.diff(found.scores) <= 0).all()
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-6)


@pytest.mark.parametrize(("method", "degrees"), [("kazhdan's grid", 4.0), ("kazhdan", 1.0), ("cicconet", 1e-5)])
def test_planes_move_with_the_cloud(method, degrees, quadruped, rng):
    turn, shift, scale = turned(rng), np.array([30.0, -5.0, 100.0]), 250.0
    here = METHODS[method].rank(quadruped.points, rng).plane()
    there = METHODS[method].rank(scale * quadruped.points @ turn.T + shift, rng).plane()
    normal = turn @ here.normal
    moved = Plane(normal, scale * here.offset + normal @ shift)
    assert there.angle(moved) < degrees
    middle = scale * turn @ quadruped.points.mean(axis=0) + shift
    apart = np.abs(there.signed_distance(middle[None])) - np.abs(moved.signed_distance(middle[None]))
    assert abs(apart[0]) < 1e-5 * scale * quadruped.diagonal


@pytest.mark.parametrize("method", METHODS)
def test_the_same_seed_gives_the_same_planes(method, quadruped):
    few = {"max_points": 700} if method == "cicconet" else {"num_normals": 400, "resolution": 32}
    quick = replace(METHODS[method], **few)
    one, other = (quick.rank(quadruped.points, np.random.default_rng(3)) for _ in range(2))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("method", ["kazhdan", "cicconet"])
def test_a_box_has_three_planes(method, rng):
    turn = turned(rng)
    found = METHODS[method].rank(box(rng) @ turn.T, rng)
    for axis in turn.T:
        assert min(found.plane(k).angle(Plane(axis, np.float64(0))) for k in range(3)) < 1


class TestKazhdan:
    def test_all_planes_pass_through_the_mean_and_are_10_degrees_apart(self, quadruped, rng):
        found = COARSE.rank(quadruped.points + 3, rng)
        np.testing.assert_allclose(found.normals @ (quadruped.points.mean(axis=0) + 3), found.offsets)
        for k in range(1, len(found.normals)):
            others = plane_distance(Plane(found.normals[:k], np.zeros(k)), Plane(found.normals[k], np.float64(0.0)))
            assert (np.degrees(2 * np.arcsin(others / 2)) > 9.99).all()

    def test_a_plane_that_does_not_pass_through_the_mean_is_not_found(self, rng):
        planted = Plane(unit(rng), np.float64(0.7))
        points = mirrored(rng, planted.normal, 0.7)
        cut = points[planted.signed_distance(points) < 0.3]
        found = COARSE.rank(cut, rng)
        foot = planted.signed_distance(cut.mean(axis=0)[None])[0]
        assert abs(foot) > 0.1
        np.testing.assert_allclose(found.normals @ cut.mean(axis=0), found.offsets)

    def test_refinement_never_lowers_the_best_score(self, quadruped, rng):
        grid, fine = (replace(COARSE, refine=on).rank(quadruped.points, rng) for on in (False, True))
        assert fine.scores[0] >= grid.scores[0]

    def test_an_exact_mirror_plane_along_the_grid_has_no_asymmetry(self, rng):
        raster = kazhdan.rasterise(mirrored(rng, np.array([1.0, 0.0, 0.0]), 0.0) - (0.0, 1.2, 0.6), 32)
        assert raster.asymmetry(np.array([1.0, 0.0, 0.0])) == 0
        assert raster.asymmetry(np.array([0.0, 1.0, 0.0])) > 1

    def test_the_asymmetry_is_a_squared_distance(self):
        # the mirror image of the voxel is 8 voxels from the shape
        raster = kazhdan.Raster(np.array([[-4.5, 0.5, 0.5]]), np.full((32, 32, 32), 8.0))
        assert raster.asymmetry(np.array([1.0, 0.0, 0.0])) == pytest.approx(64)

    def test_points_outside_the_grid_are_dropped(self, rng):
        points = rng.normal(size=(500, 3))
        far = np.concatenate([points, [[40.0, 0.0, 0.0], [-40.0, 0.0, 0.0]]])
        scale = 16 / (2 * np.sqrt((far**2).sum(axis=1).mean()))
        reach = np.linalg.norm(kazhdan.rasterise(far, 32).voxels, axis=1).max()
        assert reach == pytest.approx(scale * np.linalg.norm(points, axis=1).max(), abs=1)


class TestCicconet:
    @pytest.mark.parametrize("offset", [0.0, -0.8])
    def test_the_composition_of_reflection_and_motion_is_the_planted_reflection(self, offset, rng):
        for _ in range(20):
            v, omega, axis = unit(rng), rng.normal(), unit(rng)
            across = np.eye(3) - 2 * np.outer(v, v)
            R = across @ (np.eye(3) - 2 * np.outer(axis, axis))
            t = 2 * omega * v - 2 * offset * R @ axis
            normal, point = plane_of_composition(Registration(R, t, 0.0), axis, offset)
            assert abs(normal @ v) == pytest.approx(1, abs=1e-12)
            assert v @ point == pytest.approx(omega, abs=1e-12)

    def test_a_rotation_about_the_normal_does_not_change_the_plane(self, rng):
        v, omega, axis = unit(rng), 0.4, unit(rng)
        across = Rotation.from_rotvec(0.3 * v).as_matrix() @ (np.eye(3) - 2 * np.outer(v, v))
        R = across @ (np.eye(3) - 2 * np.outer(axis, axis))
        normal, point = plane_of_composition(Registration(R, 2 * omega * v, 0.0), axis, 0.0)
        assert abs(normal @ v) == pytest.approx(1, abs=1e-12)
        assert v @ point == pytest.approx(omega, abs=1e-12)

    def test_the_best_rigid_motion_of_planted_pairs(self, rng):
        x = rng.normal(size=(50, 3))
        planted, shift = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3)
        R, t = rigid_motion(x, x @ planted.T + shift)
        np.testing.assert_allclose(R, planted, atol=1e-12)
        np.testing.assert_allclose(t, shift, atol=1e-12)

    def test_a_rigid_motion_is_never_a_reflection(self, rng):
        x = rng.normal(size=(50, 3))
        R, _ = rigid_motion(x, -x)
        assert np.linalg.det(R) == pytest.approx(1)

    def test_icp_recovers_a_small_motion(self, rng):
        x = rng.uniform(size=(400, 3)) * (3, 2, 1)
        planted, shift = Rotation.from_rotvec([0.02, -0.03, 0.01]).as_matrix(), np.array([0.02, 0.01, -0.02])
        found = register(x, cKDTree(x @ planted.T + shift), max_steps=100, tol=1e-6)
        np.testing.assert_allclose(found.rotation, planted, atol=1e-10)
        np.testing.assert_allclose(found.translation, shift, atol=1e-10)
        assert found.rmse < 1e-10

    def test_registration_improves_a_plane_off_the_principal_axes_and_off_the_mean(self, quadruped, rng):
        cut = quadruped.points[quadruped.points @ rng.normal(size=3) > -0.2 * quadruped.diagonal]
        centred = cut - cut.mean(axis=0)
        start = min(
            float(quadruped.planes[0].angle(Plane(axis, np.float64(0))))
            for axis in np.linalg.eigh(centred.T @ centred)[1].T
        )
        assert deviation(Cicconet().rank(cut, rng).plane(), quadruped).angle < start

    def test_the_score_is_the_remaining_distance_or_as_released_the_strength(self, quadruped, rng):
        few = quadruped.points[:700]
        noisy = few + 0.03 * quadruped.diagonal * rng.normal(size=few.shape)
        clean, worse = (Cicconet().rank(points, rng).scores for points in (few, noisy))
        assert worse[0] < clean[0] < 0
        for points in (few, noisy):
            assert Cicconet(as_released=True).rank(points, rng).scores[0] == 1

    def test_strengths_are_inversely_proportional_to_the_distances(self):
        np.testing.assert_allclose(cicconet.strengths(np.array([0.2, 0.1, 0.4])), [0.5, 1, 0.25])

    def test_scores_of_an_exact_cloud_are_finite(self, rng):
        half = rng.integers(1, 9, size=(60, 3)).astype(float)
        exact = np.concatenate([half, half * (-1, 1, 1)]) * (1, 2, 4)
        assert Cicconet().rank(exact, rng).scores[0] == pytest.approx(0, abs=1e-12)
        released = Cicconet(as_released=True).rank(exact, rng)
        assert released.scores[0] == 1
        assert np.isfinite(released.scores).all()

    def test_the_released_scaling_distorts_planes_that_are_oblique_to_the_coordinates(self, rng):
        upright, oblique = np.array([1.0, 0.0, 0.0]), np.array([0.8, 0.6, 0.0])
        for normal, bent in ((upright, False), (oblique, True)):
            points = mirrored(rng, normal, 0.0)
            off = Cicconet(as_released=True).rank(points, rng).plane().angle(Plane(normal, np.float64(0)))
            assert (off > 2) == bent
