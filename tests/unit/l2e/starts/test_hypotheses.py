"""Hypotheses: one inlier is enough, the kept planes are distinct, and pairs of weight 0 propose nothing."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import deviation_angle, fibonacci
from symjax.geometry.plane import Plane
from symjax.l2e.objective import scaled_log_loss
from symjax.l2e.pairs.normalised import NormalisedPairs, normalise_pairs, systematic_sample
from symjax.l2e.pairs.padded import pad_pairs
from symjax.l2e.starts.hypotheses import (
    NUM_RANKING_PAIRS,
    SAME_ANGLE,
    SAME_OFFSET,
    offset_search,
    pair_hypotheses,
    plane_nms,
    rank_hypotheses,
)

NUM, BUCKET = 200, 256
SIGMA = jnp.asarray(0.05)


def normalised(x, y, weights=None):
    """The pairs as the solvers take them: padded, centred, scaled."""
    return made(*pad_pairs(x, y, weights)[:3])


made = jax.jit(normalise_pairs)
proposed_by = jax.jit(pair_hypotheses)
screen = jax.jit(lambda proposed, pairs, sigma: rank_hypotheses(proposed, pairs, sigma))
drawn = jax.jit(systematic_sample, static_argnums=1)


@pytest.fixture(scope="module")
def planted():
    return planted_pairs(np.random.default_rng(21), NUM, 0.8)


def in_own_units(points, pairs: NormalisedPairs):
    """Planes (v, ω) of normalised pairs as planes in the units of the points."""
    back = jax.tree.map(np.asarray, pairs.to_given)
    return back.plane(Plane(np.asarray(points)[:, :3], np.asarray(points)[:, 3]))


def alike(points, plane):
    """Which of the planes are near a plane; (v, ω) and (−v, −ω) are the same plane."""
    side = np.where(points[:, :3] @ plane[:3] < 0, -1, 1)
    near = deviation_angle(points[:, :3], np.broadcast_to(plane[:3], (len(points), 3))) < SAME_ANGLE
    return near & (np.abs(side * points[:, 3] - plane[3]) < SAME_OFFSET)


def test_every_pair_is_mirrored_exactly_by_the_plane_it_proposes(planted):
    pairs = normalised(planted.x, planted.y)
    normals, offsets = in_own_units(proposed_by(pairs).points, pairs)
    expected = planted.y - planted.x
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    cosine = np.abs(normals @ expected.T)
    pair = cosine.argmax(axis=1)
    assert len(np.unique(pair)) == NUM  # every pair proposes a plane
    np.testing.assert_allclose(cosine.max(axis=1), 1, atol=1e-12)
    x, y = planted.x[pair], planted.y[pair]
    image = x - 2 * (np.sum(x * normals, axis=1) - offsets)[:, None] * normals
    np.testing.assert_allclose(image, y, atol=1e-11)


def test_one_inlier_determines_the_plane(planted):
    """Its plane is among the hypotheses, and with two more inliers it is the best."""
    inlier = np.flatnonzero(planted.inlier)
    length = np.linalg.norm((planted.y - planted.x)[inlier], axis=1)
    few = inlier[np.argsort(-length)[:3]]
    rows = np.concatenate([few, np.flatnonzero(~planted.inlier)])
    pairs = normalised(planted.x[rows], planted.y[rows])
    proposed = proposed_by(pairs)
    normals, offsets = in_own_units(proposed.points, pairs)
    right = deviation_angle(normals, np.broadcast_to(planted.normal, normals.shape)) < 3
    right &= np.abs(np.abs(offsets) - abs(planted.offset)) < 0.1
    assert np.any(right & np.asarray(proposed.usable))
    normals, _ = in_own_units(screen(proposed, pairs, jnp.asarray(0.02)), pairs)
    assert deviation_angle(normals[0], planted.normal) < 3


@pytest.mark.parametrize("sigma", [0.02, 0.1, 0.5])
def test_kept_hypotheses_are_distinct_and_the_best_come_first(sigma):
    p = planted_pairs(np.random.default_rng(22), NUM_RANKING_PAIRS, 0.8)  # every pair is in the ranking sample once
    pairs = normalised(p.x, p.y)
    proposed = proposed_by(pairs)
    kept = np.asarray(screen(proposed, pairs, jnp.asarray(sigma)))
    for k in range(len(kept)):
        assert alike(kept, kept[k]).sum() == 1
    loss = jax.jit(jax.vmap(lambda z: scaled_log_loss(z[:3], z[3], sigma, pairs.x, pairs.y)))
    everyone = np.asarray(loss(proposed.points))[np.asarray(proposed.usable)]
    values = np.asarray(loss(kept))
    rounding = 1e-5 * sigma**2  # they are ranked in float32
    assert (np.diff(values) >= -rounding).all()
    assert values[0] <= everyone.min() + rounding
    # a dropped hypothesis that is better than the last one kept is near one of those kept
    for z in np.asarray(proposed.points)[np.asarray(proposed.usable)][everyone < values[-1] - rounding]:
        assert alike(kept, z).any()


def turned(angle, offset):
    return [np.sin(np.radians(angle)), 0, np.cos(np.radians(angle)), offset]


choose = jax.jit(plane_nms, static_argnums=2)


def test_near_duplicates_are_dropped():
    planes = [(0, 0), (4.9, 0), (5.1, 0), (0, 0.029), (0, 0.031), (179, 0.0), (180, 0.02), (180, -0.2), (90, 0)]
    points = jnp.asarray([turned(*plane) for plane in planes])
    values = jnp.arange(9.0)
    rows = choose(points, values, 5)
    # a rotation by 180 degrees flips the normal: the plane of (180, 0.2) is that of (0, −0.2)
    assert rows.tolist() == [0, 2, 4, 7, 8]
    assert choose(points, values, 3).tolist() == [0, 2, 4]
    assert choose(points, values[::-1], 2).tolist() == [8, 7]


def test_the_best_is_repeated_if_there_are_too_few_distinct_planes():
    points = jnp.asarray([turned(1, 0), turned(0, 0), turned(60, 0), turned(61, 0)])
    assert choose(points, jnp.asarray([2.0, 1.0, 3.0, jnp.inf]), 6).tolist() == [1, 2, 1, 1, 1, 1]
    assert choose(points, jnp.asarray([2.0, jnp.inf, jnp.inf, jnp.inf]), 3).tolist() == [0, 0, 0]


def test_fewer_pairs_than_hypotheses_work_too():
    x = np.random.default_rng(2).normal(size=(3, 3))
    y = x * [-1, 1, 1]
    pairs = normalised(x, y)
    kept = np.asarray(screen(proposed_by(pairs), pairs, SIGMA))
    normals, offsets = in_own_units(kept, pairs)
    np.testing.assert_allclose(np.abs(normals), np.tile([1, 0, 0], (len(kept), 1)), atol=1e-12)
    np.testing.assert_allclose(offsets, 0, atol=1e-12)


def counts(weights, num):
    return np.bincount(np.asarray(drawn(jnp.asarray(weights), num)), minlength=len(weights))


@pytest.mark.parametrize("num", [1, 7, 512, 1024])
def test_pairs_are_drawn_in_proportion_to_their_weights(num):
    rng = np.random.default_rng(5)
    for weights in (np.ones(NUM), rng.uniform(0, 1, NUM), rng.exponential(size=NUM) ** 3):
        expected = num * weights / weights.sum()
        # one from every stratum of the total weight
        assert np.abs(counts(weights, num) - expected).max() < 2
        np.testing.assert_array_equal(counts(1e-6 * weights, num), counts(weights, num))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("absent", [[0], [NUM - 1], range(50), range(150, NUM), range(0, NUM, 2), range(1, NUM, 2)])
def test_pairs_of_weight_zero_are_never_drawn(absent, dtype):
    weights = np.ones(NUM, dtype)
    weights[list(absent)] = 0
    for num in (4, 512, 1024):
        assert counts(weights, num)[list(absent)].sum() == 0


def test_no_order_of_the_pairs_is_drawn_unevenly():
    """The sample does not resonate with pairs that alternate between good and bad."""
    for period in (2, 3, 4, 8, 16):
        found = counts(np.ones(4080), 512).reshape(-1, period).sum(axis=0)
        assert np.abs(found / 512 - 1 / period).max() < 0.03


@pytest.mark.parametrize("absent", [range(60), range(100, 180), range(0, NUM, 3)])
def test_pairs_of_weight_zero_or_length_zero_propose_nothing(absent):
    planted = planted_pairs(np.random.default_rng(23), NUM, 0.5)
    x, y, weights = planted.x.copy(), planted.y.copy(), np.ones(NUM)
    away, points = np.array_split(list(absent), 2)
    weights[away] = 0
    x[away], y[away] = 1e100, -1e100
    y[points] = x[points]
    pairs = normalised(x, y, weights)
    proposed = proposed_by(pairs)
    assert np.isfinite(proposed.points).all()
    given = np.setdiff1d(np.arange(NUM), list(absent))
    direction = (y - x)[given]
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    usable = np.asarray(proposed.points)[np.asarray(proposed.usable)]
    assert len(usable) > 500
    assert np.abs(usable[:, :3] @ direction.T).max(axis=1).min() > 1 - 1e-12
    kept = screen(proposed, pairs, SIGMA)
    normals, _ = in_own_units(kept, pairs)
    assert np.abs(normals @ direction.T).max(axis=1).min() > 1 - 1e-12
    assert deviation_angle(normals[0], planted.normal) < 5


def test_a_normal_gets_the_best_of_the_offsets_tried(planted):
    pairs = normalised(planted.x, planted.y)
    raised = offset_search(pairs)
    sigma = jnp.asarray(0.1)
    v = jnp.concatenate([fibonacci(20), jnp.asarray(planted.normal)[None]])
    points = jax.jit(jax.vmap(raised, (0, None)))(v, sigma)
    np.testing.assert_array_equal(points[:, :3], v)
    offsets = np.asarray(v @ raised.candidates)
    m, h = raised.midpoints, raised.half_differences
    x, y = (m - h).T, (m + h).T
    loss = jax.jit(jax.vmap(jax.vmap(lambda v, w: scaled_log_loss(v, w, sigma, x, y), (None, 0))))
    best = np.asarray(loss(v, jnp.asarray(offsets))).argmin(axis=1)
    np.testing.assert_allclose(points[:, 3], offsets[np.arange(21), best], rtol=1e-12)
