"""Non-maximum suppression keeps the best of the planes that are near each other, and all other planes."""

import jax.numpy as jnp
import numpy as np
import pytest

from symjax.geometry.plane import Plane
from symjax.geometry.plane_nms import near, suppress


def planes(*rows):
    table = np.array(rows, dtype=float)
    normals = table[:, :3] / np.linalg.norm(table[:, :3], axis=1, keepdims=True)
    return Plane(normals, table[:, 3])


def tilted(degrees, offset=0.0):
    return (np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0, offset)


def test_the_first_of_near_planes_is_kept_whatever_the_sign_of_its_normal():
    all_planes = planes(tilted(0), tilted(3), tilted(180), tilted(90))
    kept = suppress(all_planes, np.array([1, 0, 2, 3]), angle=5.0, offset=0.02, most=4)
    assert kept.tolist() == [1, 3]


def test_parallel_planes_far_apart_are_both_kept():
    all_planes = planes(tilted(0, 0.1), tilted(180, 0.1), tilted(180, -0.1))
    assert suppress(all_planes, np.arange(3), angle=5.0, offset=0.02, most=3).tolist() == [0, 1]


def test_no_more_planes_than_requested_are_kept():
    many = planes(*(tilted(angle) for angle in range(0, 180, 10)))
    assert suppress(many, np.arange(18), angle=5.0, offset=0.02, most=4).tolist() == [0, 1, 2, 3]
    assert len(suppress(many, np.arange(18), angle=5.0, offset=0.02, most=50)) == 18


def test_kept_planes_are_far_apart_and_the_others_are_near_a_better_one(rng):
    normals = rng.normal(size=(300, 3))
    some = Plane(normals / np.linalg.norm(normals, axis=1, keepdims=True), rng.uniform(-0.1, 0.1, 300))
    order = rng.permutation(300)
    kept = suppress(some, order, angle=12.0, offset=0.05, most=300)
    rank = {row: place for place, row in enumerate(order)}

    for row in range(300):
        beside = np.flatnonzero(near(some, Plane(some.normal[row], some.offset[row]), angle=12.0, offset=0.05))
        kept_beside = set(beside.tolist()) & set(kept.tolist())
        if row in kept:
            assert kept_beside == {row}
        else:
            assert min(rank[other] for other in kept_beside) < rank[row]


@pytest.mark.parametrize(("degrees", "offset", "same"), [(3.9, 0.019, True), (4.1, 0.0, False), (0.0, 0.021, False)])
@pytest.mark.parametrize("xp", [np, jnp])
def test_near_planes_are_within_both_limits_for_either_sign(xp, degrees, offset, same):
    both = planes(tilted(degrees, offset), tilted(degrees + 180, -offset))
    first = Plane(xp.asarray([1.0, 0.0, 0.0]), xp.asarray(0.0))
    found = near(Plane(*(xp.asarray(part) for part in both)), first, angle=4.0, offset=0.02)
    assert found.tolist() == [same, same]
