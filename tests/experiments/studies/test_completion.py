"""Completion: the part that is removed, and distances that a right plane lowers and a wrong one does not."""

import dataclasses

import numpy as np
import pytest

from experiments.comparison.attempt import Attempt
from experiments.studies.paper import completion

CONFIG = dataclasses.replace(completion.SIZES["small"], kinds="quadruped", num_points=800, methods="pca")


SEED = 3
"""Of an object of which three quarters of the removed part are on one side: what is gone on both cannot be mirrored."""


@pytest.fixture(scope="module")
def cut():
    return completion.part(CONFIG, "human", SEED, posed=True)


def test_a_part_is_removed_and_the_other_samples_have_none_of_its_points(cut):
    assert len(cut.removed) == int(CONFIG.missing * CONFIG.num_points)
    assert len(cut.kept) + len(cut.removed) == len(cut.anew) == CONFIG.num_points
    assert len(cut.whole.points) == 2 * CONFIG.num_points
    everything = np.concatenate([cut.kept, cut.removed, cut.anew, cut.whole.points])
    assert len(np.unique(everything, axis=0)) == 4 * CONFIG.num_points


def test_the_same_part_is_removed_in_the_pose_and_out_of_it(cut):
    upright = completion.part(CONFIG, "human", SEED, posed=False)
    spread, own = (
        np.concatenate([np.linalg.norm(part - part.mean(axis=0), axis=1) for part in (of.kept, of.removed)])
        for of in (cut, upright)
    )
    scale = own.max() / spread.max()
    np.testing.assert_allclose(spread, own / scale, atol=1e-9)
    # lengths are in diagonals of the object
    assert scale == pytest.approx(upright.whole.diagonal, rel=0.02)


def test_the_right_plane_closes_the_gap_and_a_plane_far_away_adds_points_beside_the_object(cut):
    nothing = completion._errors(cut, cut.kept, np.empty((0, 3)))
    right = completion._mirrored(cut, cut.plane)
    wrong = completion._mirrored(cut, cut.plane._replace(offset=cut.plane.offset + 5.0))
    assert right["gap, mean"] < 0.7 * nothing["gap, mean"]
    assert right["added, 95 %"] < 0.03
    assert wrong["gap, mean"] == pytest.approx(nothing["gap, mean"])
    assert wrong["added, 95 %"] > 5.0


def test_what_was_not_removed_leaves_no_gap(cut):
    whole = cut._replace(kept=np.concatenate([cut.kept, cut.removed]))
    assert completion._errors(whole, whole.kept, np.empty((0, 3)))["gap, mean"] == 0.0


def test_no_answer_leaves_the_object_as_it_was(monkeypatch, cut):
    monkeypatch.setattr(completion, "attempt", lambda method, points: Attempt(None, 0.0, "gave up"))
    rows = {row["completed by"]: row for row in completion._completed(cut, ["pca"])}
    assert rows["PCA"]["gap, mean"] == rows[completion.OPEN]["gap, mean"]
    assert rows["PCA"]["angle"] == 90.0


def test_the_table_has_all_objects_and_every_kind():
    lines = completion.summary(completion.run(CONFIG))
    ways = [completion.OPEN, "PCA", completion.TRUE, completion.ANEW]
    assert [(line["objects"], line["completed by"]) for line in lines] == [
        (objects, way) for objects in ("all", "quadruped") for way in ways
    ]
    by_way = {line["completed by"]: line for line in lines}
    assert (
        by_way[completion.ANEW]["gap, 95 %"]
        <= by_way[completion.TRUE]["gap, 95 %"]
        <= by_way[completion.OPEN]["gap, 95 %"]
    )
    assert by_way[completion.TRUE]["median deg"] == 0.0
    # what lies on the object is still a little beside the points of another sample
    assert 0 < by_way[completion.ANEW]["added, 95 %"] <= 1.1 * by_way[completion.TRUE]["added, 95 %"]
