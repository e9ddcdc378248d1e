"""One run of a method on a cloud, and its planes as a ranking."""

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


def test_the_default_method_accepts_its_mirror_planes_and_ranks_them_first(boat):
    detection = attempt(ENTRIES[OURS], boat.points).detection
    direct = symjax.detect(boat.points, rng=0)
    ranking, accepted = ranked_planes(detection)
    assert ranking.plane().angle(direct.plane) == 0
    assert accepted.sum() == len(direct.planes)
    assert (len(accepted), detection.found) == (len(direct.candidates), direct.found)
    assert (np.diff(ranking.scores) <= 0).all()
    # rejected candidates are ranked last
    assert (np.diff(accepted.astype(int)) <= 0).all()


def test_a_baseline_keeps_its_scores(boat):
    detection = attempt(ENTRIES["kazhdan"], boat.points).detection
    ranking, accepted = ranked_planes(detection)
    assert ranking.scores.tolist() == [candidate.ranking_score for candidate in detection.candidates]
    assert accepted.sum() == 1
    largest = np.take_along_axis(ranking.normals, np.abs(ranking.normals).argmax(axis=1)[:, None], axis=1)
    assert (largest > 0).all()


def test_an_exception_counts_as_no_answer():
    failed = attempt(ENTRIES["sym-hks"], np.zeros((5, 3)))
    assert failed.detection is None
    assert "Error" in failed.error


def test_the_methods_of_the_study_robustness_are_in_the_registry():
    assert set(robustness.METHODS) <= set(ENTRIES)


def test_a_method_whose_package_is_missing_is_skipped_with_a_message(monkeypatch, capsys):
    monkeypatch.setattr(registry.importlib.util, "find_spec", lambda name: None)
    assert registry.usable(["pca", PYCLARCS]) == ["pca"]
    assert "PYCLARCS IS NOT INSTALLED" in capsys.readouterr().err
