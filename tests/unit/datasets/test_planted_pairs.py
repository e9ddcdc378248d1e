import numpy as np
import pytest

from symjax.datasets.planted_pairs import SEMI_AXES, planted_pairs
from symjax.errors import InvalidArgumentError


@pytest.mark.parametrize("blob", SEMI_AXES)
def test_inliers_are_mirror_pairs_and_outliers_are_not(rng, blob):
    p = planted_pairs(rng, 400, 0.65, blob)
    image = p.x - 2 * (p.x @ p.normal - p.offset)[:, None] * p.normal
    distance = np.linalg.norm(p.y - image, axis=1)
    assert p.inlier.sum() == 140
    assert distance[p.inlier].max() < 0.06
    assert np.median(distance[~p.inlier]) > 0.3
    assert np.linalg.norm(p.normal) == pytest.approx(1)


def test_blobs_differ_in_their_width_along_the_normal(rng):
    share = {}
    for blob in SEMI_AXES:
        p = planted_pairs(rng, 4000, 0.0, blob)
        widths = np.sqrt(np.linalg.eigvalsh(np.cov(p.x.T)))
        share[blob] = np.std(p.x @ p.normal) / widths.max()
    assert share["isotropic"] == pytest.approx(1, abs=0.05)
    assert share["wide"] == pytest.approx(1, abs=0.05)
    assert share["thin"] == pytest.approx(0.4, abs=0.05)


def test_the_same_seed_gives_the_same_pairs():
    a, b = (planted_pairs(np.random.default_rng(5), 10, 0.5) for _ in range(2))
    for left, right in zip(a, b, strict=True):
        np.testing.assert_array_equal(left, right)


def test_bad_arguments_are_refused(rng):
    with pytest.raises(InvalidArgumentError, match="'cube' is unknown"):
        planted_pairs(rng, 10, 0.5, "cube")
    with pytest.raises(InvalidArgumentError, match="between 0 and 1"):
        planted_pairs(rng, 10, 65.0)
