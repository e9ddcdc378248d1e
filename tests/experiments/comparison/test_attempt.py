"""What a method makes of a cloud, and its planes as a ranking."""

import numpy as np
import pytest

import symjax
from experiments.baselines import registry
from experiments.baselines.registry import ENTRIES, OURS, PYCLARCS
from experiments.comparison.attempt import attempt, ranked_planes
from experiments.data.cases import generate_case
from experiments.studies.robust import robustness


@pytest.fixture(scope="module")
def boat():
    return generate_case("boat", 700, 3)


def test_ours_holds_what_it_takes_for_mirror_planes(boat):
    found = attempt(ENTRIES[OURS], boat.points).detection
    direct = symjax.detect(boat.points, rng=0)
    ranking, held = ranked_planes(found)
    assert ranking.plane().angle(direct.plane) == 0
    assert held.sum() == len(direct.planes)
    assert (len(held), found.found) == (len(direct.candidates), direct.found)
    assert (np.diff(ranking.scores) <= 0).all()
    # what it doubts stands behind
    assert (np.diff(held.astype(int)) <= 0).all()


def test_a_baseline_keeps_its_scores(boat):
    found = attempt(ENTRIES["kazhdan"], boat.points).detection
    ranking, held = ranked_planes(found)
    assert ranking.scores.tolist() == [candidate.ranking_score for candidate in found.candidates]
    assert held.sum() == 1
    largest = np.take_along_axis(ranking.normals, np.abs(ranking.normals).argmax(axis=1)[:, None], axis=1)
    assert (largest > 0).all()


def test_a_method_that_raises_has_given_no_answer():
    failed = attempt(ENTRIES["sym-hks"], np.zeros((5, 3)))
    assert failed.detection is None
    assert "Error" in failed.error


def test_methods_that_are_compared_as_they_stand_are_of_the_arena():
    assert set(robustness.METHODS) <= set(ENTRIES)


def test_a_package_that_is_absent_is_said_loudly(monkeypatch, capsys):
    monkeypatch.setattr(registry.importlib.util, "find_spec", lambda name: None)
    assert registry.usable(["pca", PYCLARCS]) == ["pca"]
    assert "PYCLARCS IS NOT INSTALLED" in capsys.readouterr().err
