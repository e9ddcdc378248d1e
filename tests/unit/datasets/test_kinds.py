"""Generated objects: their planes are exact and complete, their points are uniform by area, and seeds vary them."""

import functools
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.stats import chi2

from symjax.datasets import KINDS, build, generate, pose
from symjax.datasets.solids.csg import difference, intersection, union
from symjax.datasets.solids.primitives import (
    arc,
    box,
    capsule,
    cylinder,
    ellipsoid,
    frustum,
    halfspace,
    lathe,
    sphere,
    torus,
)
from symjax.datasets.solids.surface import LIPSCHITZ, ROOT, cover, sample_surface
from symjax.errors import InvalidArgumentError

SINGLE = [name for name, kind in KINDS.items() if kind.symmetry == "single"]
MULTIPLE = [name for name, kind in KINDS.items() if kind.symmetry == "multiple"]
CONTINUOUS = [name for name, kind in KINDS.items() if kind.symmetry == "continuous"]
ASYMMETRIC = [name for name, kind in KINDS.items() if kind.symmetry == "none"]


@functools.cache
def example(kind):
    """Returns a small sample of a kind and the field whose zero set was sampled."""
    return generate(kind, num_points=250, rng=3), build(kind, 3).field


def residuals(points, field, normals, offsets):
    """Computes the mean |f| at the points' mirror images in each plane, as a fraction of the diagonal."""
    normals = np.asarray(normals)
    height = points @ normals.T - offsets
    images = points[:, None, :] - 2 * height[:, :, None] * normals
    values = np.abs(field(images.reshape(-1, 3).T.copy())).reshape(height.shape)
    return values.mean(axis=0) / np.linalg.norm(np.ptp(points, axis=0))


def half_sphere(count):
    """Returns directions spread evenly over a hemisphere (Fibonacci)."""
    z = 1 - (np.arange(count) + 0.5) / count
    turn = np.pi * (1 + 5**0.5) * np.arange(count)
    r = np.sqrt(1 - z**2)
    return np.column_stack([r * np.cos(turn), r * np.sin(turn), z])


def chi_square_p(counts, shares):
    expected = counts.sum() * np.asarray(shares)
    return chi2.sf(((counts - expected) ** 2 / expected).sum(), len(counts) - 1)


def test_there_are_enough_kinds_of_every_symmetry():
    assert len(SINGLE) >= 12
    assert min(len(MULTIPLE), len(CONTINUOUS), len(ASYMMETRIC)) >= 5
    assert all(kind.description for kind in KINDS.values())


@pytest.mark.parametrize("kind", KINDS)
def test_points_are_on_the_surface_inside_the_cube_and_the_planes_are_exact(kind):
    sample, field = example(kind)
    assert sample.points.shape == (250, 3)
    assert sample.points.dtype == np.float64
    assert np.abs(field(sample.points.T.copy())).max() <= 1e-9
    assert np.abs(sample.points).max() < ROOT - 0.05
    np.testing.assert_allclose(np.linalg.norm(sample.normals, axis=1), 1, atol=1e-15)
    if len(sample.normals):
        assert residuals(sample.points, field, sample.normals, sample.offsets).max() <= 1e-9


@pytest.mark.parametrize("kind", SINGLE + MULTIPLE + ASYMMETRIC)
def test_there_is_no_other_plane(kind):
    sample, field = example(kind)
    assert len(sample.normals) == {"single": 1, "none": 0}.get(sample.symmetry, len(sample.normals))
    directions = np.vstack([half_sphere(150), np.eye(3)])
    if len(sample.normals):
        cosine = np.abs(directions @ sample.normals.T).max(axis=1)
        directions = directions[cosine < np.cos(np.radians(12))]
    offsets = directions @ sample.points.mean(axis=0)
    least = residuals(sample.points, field, directions, offsets).min()
    assert least > (0.01 if sample.symmetry == "none" else 0.003)


@pytest.mark.parametrize("kind", CONTINUOUS)
def test_every_plane_through_the_axis_is_a_mirror(kind):
    sample, field = example(kind)
    point, direction = sample.axis
    assert abs(direction @ np.array([0.0, 0.0, 1.0])) == 1
    angles = np.linspace(0, np.pi, 7)
    normals = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(7)])
    assert residuals(sample.points, field, normals, normals @ point).max() <= 1e-9
    across = residuals(sample.points, field, np.eye(3)[2:], sample.points[:, 2:].mean(axis=0)).max()
    assert len(sample.normals) > 0 or kind == "ball" or across > 0.005


def test_some_kinds_are_widest_and_some_thinnest_along_their_normal():
    rank = {k: np.argsort(np.argsort(np.ptp(example(k)[0].points, axis=0)))[0] for k in SINGLE}
    assert {k for k in SINGLE if rank[k] == 2} >= {"aeroplane", "bird", "sofa", "spectacles"}
    assert {k for k in SINGLE if rank[k] == 0} >= {"bicycle", "fish", "hammer", "quadruped"}


@pytest.mark.parametrize("kind", SINGLE)
def test_seeds_change_the_proportions(kind):
    clouds = [example(kind)[0], generate(kind, num_points=250, rng=0)]
    shapes = np.array([np.ptp(sample.points, axis=0) for sample in clouds])
    shapes /= shapes.max(axis=1, keepdims=True)
    assert np.ptp(shapes, axis=0).max() > 0.03


def test_the_same_seed_gives_the_same_object_and_another_seed_another():
    first, again, other = (generate("mug", num_points=50, rng=s) for s in (1, 1, 2))
    np.testing.assert_array_equal(first.points, again.points)
    assert not np.allclose(first.points, other.points)
    from_generator = generate("mug", num_points=50, rng=np.random.default_rng(1))
    np.testing.assert_array_equal(first.points, from_generator.points)


def test_a_sample_does_not_contain_the_mirror_images_of_its_points():
    points = generate("human", num_points=3000, rng=0).points
    images = points * [-1, 1, 1]
    distance = cKDTree(points).query(images)[0]
    spacing = cKDTree(points).query(points, k=2)[0][:, 1]
    # mirror images are independent of the points, so their nearest points are about one spacing away
    assert distance.min() > 1e-6
    assert 0.8 < np.median(distance) / np.median(spacing) < 1.25


def test_sphere_density_is_uniform(rng):
    p = sample_surface(sphere((0.1, -0.2, 0.05), 0.8), 20000, rng) - [0.1, -0.2, 0.05]
    height = np.histogram(p[:, 2], np.linspace(-0.8, 0.8, 17))[0]  # Archimedes: equal bands, equal areas
    turn = np.histogram(np.arctan2(p[:, 1], p[:, 0]), np.linspace(-np.pi, np.pi, 17))[0]
    assert chi_square_p(height, np.full(16, 1 / 16)) > 1e-3
    assert chi_square_p(turn, np.full(16, 1 / 16)) > 1e-3


def test_box_density_is_uniform_over_faces_and_within_them(rng):
    half = np.array([0.9, 0.5, 0.03])
    p = sample_surface(box((0, 0, 0), half), 20000, rng)
    face = np.argmax(np.abs(p) - half, axis=1) + 3 * (p[np.arange(len(p)), np.argmax(np.abs(p) - half, axis=1)] > 0)
    area = np.tile([half[1] * half[2], half[0] * half[2], half[0] * half[1]], 2)
    assert chi_square_p(np.bincount(face, minlength=6), area / area.sum()) > 1e-3
    top = p[face == 5]
    cells = np.histogram2d(top[:, 0], top[:, 1], [8, 8], [[-0.9, 0.9], [-0.5, 0.5]])[0].ravel()
    assert chi_square_p(cells, np.full(64, 1 / 64)) > 1e-3


def test_torus_and_ellipsoid_and_cone_densities_follow_their_areas(rng):
    major, minor = 0.8, 0.3
    p = sample_surface(torus((0, 0, 0), (0, 0, 1), major, minor), 10000, rng)
    outer = np.count_nonzero(np.hypot(p[:, 0], p[:, 1]) > major)
    share = 0.5 + minor / (np.pi * major)
    assert chi_square_p(np.array([outer, 10000 - outer]), [share, 1 - share]) > 1e-3

    long, short = 1.2, 0.2  # a spheroid: area between heights by quadrature
    p = sample_surface(ellipsoid((0, 0, 0), (short, short, long)), 10000, rng)
    edges = np.linspace(-long, long, 4001)
    z = (edges[1:] + edges[:-1]) / 2
    density = np.sqrt(1 - (z / long) ** 2 * (1 - (short / long) ** 2))
    shares = density.reshape(16, -1).sum(axis=1) / density.sum()
    assert chi_square_p(np.histogram(p[:, 2], edges[::250])[0], shares) > 1e-3

    p = sample_surface(frustum((0, 0, 0), (0, 0, 1), 0.6, 0.0), 10000, rng)
    base = np.count_nonzero(p[:, 2] < 1e-9)
    share = 0.6 / (0.6 + np.hypot(1, 0.6))
    assert chi_square_p(np.array([base, 10000 - base]), [share, 1 - share]) > 1e-3


def test_a_union_is_sampled_on_its_outer_surface_only(rng):
    left, right = sphere((-0.3, 0, 0), 0.5), sphere((0.3, 0, 0), 0.4)
    p = sample_surface(union(left, right), 10000, rng)
    assert min(left(p.T).min(), right(p.T).min()) > -1e-9
    plane = (0.5**2 - 0.4**2 + 0.3**2 - 0.3**2) / (4 * 0.3)
    caps = np.array([0.5 * (0.5 + plane + 0.3), 0.4 * (0.4 + 0.3 - plane)])
    on_left = np.count_nonzero(p[:, 0] < plane)
    assert chi_square_p(np.array([on_left, 10000 - on_left]), caps / caps.sum()) > 1e-3


@pytest.mark.parametrize(
    "field",
    [
        sphere((0.1, 0, 0), 0.5),
        box((0, 0.1, 0), (0.6, 0.3, 0.2), 0.05),
        capsule((0, 0, -0.5), (0.3, 0.2, 0.5), 0.3, 0.1),
        cylinder((0, 0, -0.5), (0, 0.4, 0.5), 0.4, 0.05),
        frustum((0, 0, -0.5), (0.2, 0, 0.6), 0.5, 0.2),
        torus((0, 0, 0), (1, 1, 0), 0.6, 0.2),
        arc((0, 0, 0), (1, 0, 0), (0, 1, 0), 0.6, 0.15, 2.0),
        lathe(np.array([[0, -0.6], [0.5, -0.6], [0.3, 0.2], [0.6, 0.7], [0, 0.7]])),
        ellipsoid((0, 0, 0), (0.16, 0.9, 0.5)),
        difference(sphere((0, 0, 0), 0.6), capsule((0, 0, 0), (1, 0, 0), 0.3), blend=0.1),
        intersection(sphere((0, 0, 0), 0.6), halfspace((0, 1, 1), 0.1)),
    ],
    ids=[
        "sphere",
        "box",
        "capsule",
        "cylinder",
        "frustum",
        "torus",
        "arc",
        "lathe",
        "ellipsoid",
        "difference",
        "intersection",
    ],
)
def test_fields_are_bounded_by_the_distance_to_their_surface(field, rng):
    surface = sample_surface(field, 4000, rng)
    gap = cKDTree(surface).query(surface, k=2)[0][:, 1].max()
    p = rng.uniform(-1.2, 1.2, (3000, 3))
    distance = cKDTree(surface).query(p)[0]
    assert np.all(np.abs(field(p.T.copy())) <= LIPSCHITZ * distance + 1e-9)
    far = distance > 5 * gap  # far away, `distance` is accurate, and the field must be of the same size
    assert np.all(np.abs(field(p.T.copy()))[far] >= 0.4 * (distance[far] - gap))


def test_thin_parts_are_found(rng):
    wire = capsule((-0.9, -0.83, 0.71), (0.77, 0.9, -0.6), 0.011)
    p = sample_surface(union(sphere((0, 0, 0), 0.3), wire), 5000, rng)
    along = p @ np.array([1.67, 1.73, -1.31]) / np.linalg.norm([1.67, 1.73, -1.31])
    assert np.histogram(along, 24)[0].min() > 5
    assert cover(wire).shape[1] > 100


def test_a_pose_moves_the_planes_and_the_axis_with_the_points(rng):
    for kind in ("car", "prism", "bowl"):
        sample, _ = example(kind)
        for reflect in (False, True, None):
            posed = pose(sample, rng, scale=2.5, reflect=reflect)
            before = sample.points @ sample.normals.T - sample.offsets
            after = posed.points @ posed.normals.T - posed.offsets
            np.testing.assert_allclose(after, 2.5 * before, atol=1e-12)
            near, far = (np.linalg.norm(s.points[:50, None] - s.points[None, 50:100], axis=2) for s in (sample, posed))
            np.testing.assert_allclose(far, 2.5 * near, atol=1e-12)
            if sample.axis is not None:
                radius = [np.linalg.norm(np.cross(s.points - s.axis[0], s.axis[1]), axis=1) for s in (sample, posed)]
                np.testing.assert_allclose(radius[1], 2.5 * radius[0], atol=1e-12)


def test_reflect_sets_the_handedness(rng):
    sample, _ = example("hand")
    for reflect in (False, True):
        posed = pose(sample, rng, reflect=reflect)
        volumes = [np.linalg.det(s.points[1:4] - s.points[0]) for s in (sample, posed)]
        assert (volumes[0] * volumes[1] < 0) == reflect


def test_bad_arguments_are_refused():
    with pytest.raises(InvalidArgumentError, match=r"kind 'unicorn' is unknown: choose one of chair"):
        generate("unicorn")
    with pytest.raises(InvalidArgumentError, match="num_points"):
        generate("mug", num_points=0)
    with pytest.raises(InvalidArgumentError, match="scale"):
        pose(example("mug")[0], scale=0)
    with pytest.raises(InvalidArgumentError, match="no zero"):
        sample_surface(sphere((9, 9, 9), 1.0), 10, np.random.default_rng(0))


def test_datasets_are_imported_without_jax():
    code = "import sys, symjax.datasets; sys.exit('jax' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
