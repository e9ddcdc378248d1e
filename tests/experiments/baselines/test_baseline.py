"""Every baseline is a method of `symjax.detect`."""

import dataclasses

import numpy as np
import pytest

import symjax
from experiments.baselines.baseline import Baseline, given_points
from experiments.baselines.hruda import Hruda
from experiments.baselines.registry import ENTRIES, PYCLARCS
from experiments.data.cases import generate_case
from experiments.metrics.ranking import Ranking
from symjax.errors import MethodError
from symjax.method.protocol import Method
from symjax.method.stage_timer import StageTimer
from symjax.preprocess.cloud import prepare

BASELINES = {name: entry for name, entry in ENTRIES.items() if isinstance(entry.method, Baseline)}
QUICK = [name for name in BASELINES if name not in ("hruda", "3dsymm-26", PYCLARCS)]
"""The other baselines take seconds, or need an optional package."""


@pytest.fixture(scope="module")
def boat():
    return generate_case("boat", 700, 3)


@pytest.mark.parametrize("name", ENTRIES)
def test_a_method_is_immutable_and_hashable(name):
    method = ENTRIES[name].method
    assert isinstance(method, Method)
    assert method == dataclasses.replace(method)
    assert hash(method) == hash(dataclasses.replace(method))
    with pytest.raises(dataclasses.FrozenInstanceError):
        method.name = "another"


@pytest.mark.parametrize("name", QUICK)
def test_a_detection_has_the_planes_that_the_baseline_ranks(name, boat):
    entry = BASELINES[name]
    found = entry.detect(boat.points, np.random.default_rng(0))
    ranking = entry.method.rank(boat.points, np.random.default_rng(0))
    normals, offsets, scores = zip(*((*c.plane, c.ranking_score) for c in found.candidates), strict=True)
    np.testing.assert_allclose(normals, ranking.normals, atol=1e-6)
    np.testing.assert_allclose(offsets, ranking.offsets, atol=1e-6 * boat.diagonal)
    np.testing.assert_allclose(scores, ranking.scores, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-12)
    assert (np.diff(scores) <= 0).all()
    # a baseline accepts its best plane always, and has no scale and no pairs
    assert found.found
    assert len(found.planes) == (len(found.candidates) if entry.method.accepts_all else 1)
    np.testing.assert_array_equal([plane.normal for plane in found.planes], normals[: len(found.planes)])
    assert (found.sigma, found.threshold, found.inlier_fraction) == (None, None, None)
    assert len(found.pairs.weight) == 0


def test_a_baseline_is_a_method_of_detect(boat):
    found = symjax.detect(boat.points, method=Hruda(num_points=300, starts=2))
    assert isinstance(found, symjax.Detection)
    assert found.method == "hruda"
    assert found.plane.angle(boat.planes[0]) < 5
    assert len(found.used) == len(boat.points)


def test_a_baseline_that_ranks_nothing_is_named_in_the_error(boat, rng):
    class Empty(Baseline):
        name = "empty"
        accepts_all = True

        def rank(self, points, rng):
            return Ranking(np.empty((0, 3)), np.empty(0), np.empty(0))

    assert Empty().find(prepare(boat.points), max_planes=9, rng=rng, timer=StageTimer()).symmetry == "none"
    with pytest.raises(MethodError, match="'empty' returned no candidate"):
        symjax.detect(boat.points, Empty())


def test_a_baseline_sees_the_given_points(boat, rng):
    cloud = prepare(boat.points)
    np.testing.assert_allclose(given_points(cloud), boat.points, atol=1e-12 * boat.diagonal)
    many = rng.normal(size=(12_000, 3))
    seen = []

    class Recording(Baseline):
        name = "recording"

        def rank(self, points, rng):
            seen.append(points)
            raise LookupError

    with pytest.raises(LookupError):
        ENTRIES["pca"]._replace(method=Recording()).detect(many, rng)
    # neither thinned nor cleaned nor turned
    np.testing.assert_allclose(seen[0], many, atol=1e-12)
