"""Outliers strewn over the sheet of a flat cloud."""

import numpy as np
import pytest

from symjax.preprocess.sheet_outliers import sheet_outlier_mask


def disc(rng, count, power=0.5):
    """Returns points of a disc: evenly for a power of 1/2."""
    turn, radius = rng.uniform(0, 2 * np.pi, count), rng.uniform(size=count) ** power
    return np.c_[radius * np.cos(turn), radius * np.sin(turn)]


def ellipse(rng, count):
    return disc(rng, count) * [1.0, 0.5]


def circle(rng, count):
    turn = rng.uniform(0, 2 * np.pi, count)
    return np.c_[np.cos(turn), np.sin(turn)]


@pytest.mark.parametrize("outline", [circle, ellipse])
@pytest.mark.parametrize("share", [0.3, 1.0])
def test_outliers_beside_the_object_are_found(rng, outline, share):
    strewn = rng.uniform(-1.2, 1.2, size=(int(1_000 * share), 2))
    found = sheet_outlier_mask(np.vstack([outline(rng, 1_000), strewn]))
    assert found[:1_000].mean() < 0.1
    # those within the object or at its edge cannot be told from it
    assert (
        found[1_000:][np.abs(strewn[:, 1]) > 0.8 if outline is ellipse else np.linalg.norm(strewn, axis=1) > 1.3].mean()
        > 0.8
    )


@pytest.mark.parametrize("count", [200, 2_000])
def test_a_clean_sheet_has_none(rng, count):
    square = rng.uniform(size=(count, 2))
    for points in (square, circle(rng, count), disc(rng, count), disc(rng, count, power=1.0)):
        assert not sheet_outlier_mask(points).any()


def test_a_dense_and_a_sparse_arm_are_both_kept(rng):
    dense, sparse = (rng.uniform(size=(n, 2)) * [1, 0.2] + shift for n, shift in ((1_000, [0, 0]), (200, [-1, 0])))
    upright = rng.uniform(size=(200, 2)) * [0.2, 1]
    assert not sheet_outlier_mask(np.vstack([dense, sparse, upright])).any()
