"""Completion: the removed part, and the errors of completion by the true plane and by a wrong one."""

import dataclasses

import numpy as np
import pytest

from experiments.comparison.attempt import Attempt
from experiments.studies.paper import completion

CONFIG = dataclasses.replace(completion.SIZES["small"], kinds="quadruped", num_points=800, methods="pca")


SEED = 3
"""Seed of an object whose removed part is to three quarters on one side, so that mirroring can fill most of it."""


@pytest.fixture(scope="module")
def cut():
    return completion.part(CONFIG, "human", SEED, posed=True)


def test_a_part_is_removed_and_the_samples_share_no_points(cut):
    assert len(cut.removed) == int(CONFIG.missing * CONFIG.num_points)
    assert len(cut.kept) + len(cut.removed) == len(cut.resampled) == CONFIG.num_points
    assert len(cut.whole.points) == 2 * CONFIG.num_points
    everything = np.concatenate([cut.kept, cut.removed, cut.resampled, cut.whole.points])
    assert len(np.unique(everything, axis=0)) == 4 * CONFIG.num_points


def test_the_same_part_is_removed_in_the_objects_frame_and_in_a_random_pose(cut):
    upright = completion.part(CONFIG, "human", SEED, posed=False)
    spread, own = (
        np.concatenate([np.linalg.norm(part - part.mean(axis=0), axis=1) for part in (of.kept, of.removed)])
        for of in (cut, upright)
    )
    scale = own.max() / spread.max()
    np.testing.assert_allclose(spread, own / scale, atol=1e-9)
    # lengths are in diagonals of the object
    assert scale == pytest.approx(upright.whole.diagonal, rel=0.02)


def test_the_true_plane_closes_the_gap_and_a_distant_plane_adds_points_off_the_object(cut):
    nothing = completion._errors(cut, cut.kept, np.empty((0, 3)))
    true = completion._mirrored(cut, cut.plane)
    wrong = completion._mirrored(cut, cut.plane._replace(offset=cut.plane.offset + 5.0))
    assert true["gap, mean"] < 0.7 * nothing["gap, mean"]
    assert true["added, 95 %"] < 0.03
    assert wrong["gap, mean"] == pytest.approx(nothing["gap, mean"])
    assert wrong["added, 95 %"] > 5.0


def test_a_complete_cloud_has_no_gap(cut):
    whole = cut._replace(kept=np.concatenate([cut.kept, cut.removed]))
    assert completion._errors(whole, whole.kept, np.empty((0, 3)))["gap, mean"] == 0.0


def test_a_failed_method_has_the_errors_of_the_uncompleted_object(monkeypatch, cut):
    monkeypatch.setattr(completion, "attempt", lambda method, points: Attempt(None, 0.0, "gave up"))
    rows = {row["completed by"]: row for row in completion._completed(cut, ["pca"])}
    assert rows["PCA"]["gap, mean"] == rows[completion.NOT_COMPLETED]["gap, mean"]
    assert rows["PCA"]["angle"] == 90.0


def test_the_table_has_all_objects_and_every_kind():
    lines = completion.summary(completion.run(CONFIG))
    ways = [completion.NOT_COMPLETED, "PCA", completion.TRUE_PLANE, completion.RESAMPLED]
    assert [(line["objects"], line["completed by"]) for line in lines] == [
        (objects, way) for objects in ("all", "quadruped") for way in ways
    ]
    by_way = {line["completed by"]: line for line in lines}
    assert (
        by_way[completion.RESAMPLED]["gap, 95 %"]
        <= by_way[completion.TRUE_PLANE]["gap, 95 %"]
        <= by_way[completion.NOT_COMPLETED]["gap, 95 %"]
    )
    assert by_way[completion.TRUE_PLANE]["median deg"] == 0.0
    # points on the object have a positive distance to the points of another sample
    assert 0 < by_way[completion.RESAMPLED]["added, 95 %"] <= 1.1 * by_way[completion.TRUE_PLANE]["added, 95 %"]
