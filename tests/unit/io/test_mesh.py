"""A mesh is sampled uniformly by area, reproducibly, and in any units."""

import numpy as np
import pytest

from symjax.errors import FileFormatError
from symjax.io import mesh, parsing
from symjax.io.points import read_points
from tests.helpers.cloud_files import CUBE, QUADS, binary_ply, off, polygons, put


def test_a_mesh_is_sampled_uniformly_by_area_and_by_seed(tmp_path):
    box = CUBE * [3, 1, 1]
    path = put(tmp_path, "box.ply", binary_ply(box, QUADS))
    sampled, note = read_points(path, num_samples=30_000, rng=5)
    assert note == "mesh of 6 faces, sampled uniformly by area: 30000 points"
    on_end = (sampled[:, 0] == 0) | (sampled[:, 0] == 3)
    # the two ends have 2 of an area of 14; the tolerance is four standard deviations
    assert on_end.mean() == pytest.approx(2 / 14, abs=4 * np.sqrt(2 / 14 * 12 / 14 / 30_000))
    assert sampled.mean(axis=0) == pytest.approx([1.5, 0.5, 0.5], abs=0.03)
    np.testing.assert_array_equal(sampled, read_points(path, num_samples=30_000, rng=5).points)
    np.testing.assert_array_equal(sampled, read_points(path, num_samples=30_000, rng=np.random.default_rng(5)).points)
    assert (sampled != read_points(path, num_samples=30_000, rng=6).points).any()
    # a generator advances from one call to the next
    generator = np.random.default_rng(5)
    first, second = (read_points(path, num_samples=50, rng=generator).points for _ in range(2))
    assert (first != second).any()


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e150])
def test_sampling_does_not_depend_on_units(scale):
    solid = mesh.from_polygons(CUBE, mesh.parse_polygons(parsing.rows(polygons(QUADS).encode())))
    reference = mesh.sample(solid, 50, np.random.default_rng(1))
    scaled = mesh.sample(solid._replace(vertices=CUBE * scale), 50, np.random.default_rng(1))
    np.testing.assert_allclose(scaled / scale, reference, rtol=1e-12)


def test_faces_without_area_or_with_nan_are_refused(tmp_path):
    for vertices in (CUBE * [1, 0, 0], CUBE * 0, CUBE * [1, 1, np.nan]):
        with pytest.raises(FileFormatError, match=r"have no area|vertex 0 .* is NaN"):
            read_points(put(tmp_path, "a.off", off(vertices, QUADS)))
