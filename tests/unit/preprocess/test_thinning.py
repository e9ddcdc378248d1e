"""Thinning keeps rows of the cloud: at most as many as asked, spread as it says, and the same every time."""

import numpy as np
import pytest

from symjax.errors import DuplicatePointsWarning
from symjax.preprocess.thinning import distinct, evenly, on_grid


def test_an_even_draw_has_its_size_and_no_row_twice():
    rows = evenly(1000, 100)
    assert len(np.unique(rows)) == 100
    assert (np.diff(rows) > 0).all()
    assert rows.max() < 1000
    np.testing.assert_array_equal(rows, evenly(1000, 100))
    np.testing.assert_array_equal(evenly(7, 100), np.arange(7))
    # of both halves about the same number
    assert abs(np.count_nonzero(rows < 500) - 50) < 20


@pytest.mark.parametrize("most", [50, 400, 1500])
def test_a_grid_leaves_nearly_as_many_as_asked_and_no_more(most, rng):
    points = rng.uniform(-0.3, 0.3, size=(3000, 3))
    rows = on_grid(points, most)
    assert 0.5 * most < len(rows) <= most
    assert (np.diff(rows) > 0).all()


def test_a_grid_makes_densities_alike(rng):
    dense, sparse = rng.uniform(size=(5000, 2)) * 0.3, rng.uniform(size=(500, 2)) * 0.3 + [0.5, 0]
    points = np.c_[np.concatenate([dense, sparse]), np.zeros(5500)]
    rows = on_grid(points, 300)
    share = np.mean(rows < 5000)
    assert 0.4 < share < 0.65


def test_coincident_points_are_merged_into_the_first(rng):
    points = rng.uniform(size=(400, 3))
    notes = []
    rows = distinct(np.concatenate([points, points[:3] + 1e-12]), notes)
    np.testing.assert_array_equal(rows, np.arange(400))
    assert notes == ["3 of 403 points coincide with others and were merged"]


def test_many_coincident_points_are_warned_of_and_none_is_no_note(rng):
    points = rng.uniform(size=(100, 3))
    notes = []
    np.testing.assert_array_equal(distinct(points, notes), np.arange(100))
    assert notes == []
    with pytest.warns(DuplicatePointsWarning, match="100 of 200"):
        distinct(np.repeat(points, 2, axis=0), notes)
