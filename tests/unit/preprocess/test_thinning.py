"""Subsets have at most the requested size, the documented densities, and are deterministic."""

import numpy as np
import pytest

from symjax.errors import DuplicatePointsWarning
from symjax.preprocess.thinning import distinct_rows, grid_subset, random_subset


def test_a_random_subset_has_its_size_and_no_row_twice():
    rows = random_subset(1000, 100)
    assert len(np.unique(rows)) == 100
    assert (np.diff(rows) > 0).all()
    assert rows.max() < 1000
    np.testing.assert_array_equal(rows, random_subset(1000, 100))
    np.testing.assert_array_equal(random_subset(7, 100), np.arange(7))
    # about the same number from both halves
    assert abs(np.count_nonzero(rows < 500) - 50) < 20


@pytest.mark.parametrize("most", [50, 400, 1500])
def test_a_grid_keeps_nearly_as_many_points_as_requested_and_no_more(most, rng):
    points = rng.uniform(-0.3, 0.3, size=(3000, 3))
    rows = grid_subset(points, most)
    assert 0.5 * most < len(rows) <= most
    assert (np.diff(rows) > 0).all()


def test_a_grid_makes_densities_alike(rng):
    dense, sparse = rng.uniform(size=(5000, 2)) * 0.3, rng.uniform(size=(500, 2)) * 0.3 + [0.5, 0]
    points = np.c_[np.concatenate([dense, sparse]), np.zeros(5500)]
    rows = grid_subset(points, 300)
    share = np.mean(rows < 5000)
    assert 0.4 < share < 0.65


def test_coincident_points_are_merged_into_the_first(rng):
    points = rng.uniform(size=(400, 3))
    notes = []
    rows = distinct_rows(np.concatenate([points, points[:3] + 1e-12]), notes)
    np.testing.assert_array_equal(rows, np.arange(400))
    assert notes == ["3 of 403 points coincide with others and were merged"]


def test_many_coincident_points_cause_a_warning_and_none_no_note(rng):
    points = rng.uniform(size=(100, 3))
    notes = []
    np.testing.assert_array_equal(distinct_rows(points, notes), np.arange(100))
    assert notes == []
    with pytest.warns(DuplicatePointsWarning, match="100 of 200"):
        distinct_rows(np.repeat(points, 2, axis=0), notes)
