"""Measures, table and curves of made-up rows."""

import numpy as np
import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")


from experiments.baselines.kazhdan import Kazhdan
from experiments.comparison import published
from experiments.comparison.curves import precision_recall
from experiments.comparison.leaderboard import best_f, leaderboard, measures_of, pivot, prediction, tallies
from experiments.comparison.tracks import TRACKS
from experiments.data.cases import generate_case
from experiments.metrics import score_curve
from experiments.metrics.prediction import Prediction
from symjax.geometry.plane import Plane
from tests.experiments.comparison.rows import row, unanswered


@pytest.fixture(scope="module")
def boat():
    return generate_case("boat", 700, 3)


def test_a_row_scores_like_the_case_it_was_made_from(boat):
    ranking = Kazhdan().rank(boat.points, np.random.default_rng(0))
    from_case = row(
        planes=np.column_stack(ranking).tolist(),
        truths=[[*p.normal.tolist(), float(p.offset)] for p in boat.planes],
        centre=boat.points.mean(axis=0).tolist(),
        diagonal=boat.diagonal,
    )
    for actual, expected in zip(
        score_curve.curve([prediction(from_case)]), score_curve.curve([Prediction(ranking, boat)]), strict=True
    ):
        np.testing.assert_array_equal(actual, expected)


def test_measures_of_known_rows():
    rows = [row(item=0, angle=1.0), row(item=1, angle=4.0, offset=0.03), row(item=2, angle=30.0), unanswered(item=3)]
    line = measures_of(rows)
    assert (line["objects"], line["answered"], line["found"]) == (4, 3, 3)
    assert line["hit rate"] == 0.25
    assert [line[f"hit rate {degrees}"] for degrees in (1, 2, 10, 45)] == [0.0, 0.25, 0.25, 0.5]
    assert line["F paper"] == pytest.approx(2 * 2 / (3 + 4))
    assert line["median angle"] == pytest.approx((4 + 30) / 2)
    assert line["area"] == pytest.approx((44 / 45 + 15 / 45) / 4)
    assert (line["GTE"], line["GTE squared"], line["SDE"]) == pytest.approx((2.0, 0.04, 3.0))
    assert line["seconds"] == 2.0


def test_rejected_planes_are_not_false_positives():
    two = [[1.0, 0.0, 0.0, 0.0, 0.9], [0.0, 1.0, 0.0, 0.0, 0.5]]
    both, first = row(planes=two, accepted=[True, True]), row(planes=two, accepted=[True, False])
    assert tallies([both], "funk")[-1].precision == 0.5
    assert tallies([first], "funk")[-1].precision == 1.0
    # a threshold on the score excludes the second plane too
    assert best_f([both]) == 1.0
    assert best_f([unanswered()]) == 0.0
    other = row(item=1, planes=[[1.0, 0.0, 0.0, 0.0, 0.4]])
    # the wrong plane scores 0.5, which is more than the 0.4 of the correct one
    assert best_f([both, other]) == pytest.approx(0.8)
    assert best_f([both, other], 1) == 1.0


def test_measures_of_other_publications_use_the_accepted_planes():
    true, wrong = [1.0, 0.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.0, 0.9]
    truths = [true[:4], [0.0, 0.0, 1.0, 0.0]]
    one = measures_of([row(planes=[wrong, true], accepted=[False, True], truths=truths)])
    assert (one["PHC"], one["mAP"], one["mAP of truths"]) == (1.0, 1.0, 0.5)
    assert one["F coarse"] == pytest.approx(2 / 3)
    # at a threshold of 0 nothing matches
    assert one["F E3Sym"] == pytest.approx(2 / 3 * 200 / 201)
    both = measures_of([row(planes=[wrong, true], accepted=[True, True], truths=truths)])
    assert (both["PHC"], both["mAP"], both["mAP of truths"]) == (0.0, 0.5, 0.25)
    neither = measures_of([unanswered()])
    assert [neither[name] for name in TRACKS] == [0.0] * len(TRACKS)


def test_the_table_has_methods_by_conditions():
    rows = [row(m, i, c) for i in range(2) for c in ("clean", "out20") for m in ("pca", "hruda")]
    lines = leaderboard(rows)
    assert [(line["condition"], line["method"]) for line in lines] == [
        (c, m) for c in ("clean", "out20") for m in ("pca", "hruda")
    ]
    table = pivot(lines, ["hit rate", "seconds"])
    assert [(line["method"], line["clean"], line["out20"]) for line in table] == [
        *(("PCA", 1.0, 1.0), ("after Hruda", 1.0, 1.0)),
        *(("PCA", 2.0, 2.0), ("after Hruda", 2.0, 2.0)),
    ]


def test_the_papers_curve_is_the_diagonal_and_the_curve_over_the_score_is_not():
    rows = [row(item=k, angle=angle) for k, angle in enumerate((1.0, 7.0, 30.0))]
    rows[2]["planes"][0][4] = rows[1]["planes"][0][4] = 0.1
    points = precision_recall(rows)
    for point in points:
        if point["sweep"] == "paper":
            assert point["precision"] == point["recall"]
    assert [(p["precision"], p["recall"]) for p in points if p["sweep"] == "score"] == [
        pytest.approx((1, 1 / 3)),
        pytest.approx((1 / 3, 1 / 3)),
    ]


def test_published_numbers_have_the_conditions_of_the_table():
    lines = published.lines(published.outliers_and_missing(), ["clean", "out100", "noise1"])
    assert lines[0]["method"] == "the paper, published"
    assert (lines[0]["clean"], lines[0]["out100"], lines[0]["noise1"]) == (0.95, 0.89, "")
    assert "Funk 2017" in lines[0]["data"]
    assert published.lines(published.PARTIAL, ["clean"]) == []


def test_truths_of_a_row_are_planes():
    plane = prediction(row()).case.planes[0]
    assert plane.angle(Plane(np.array([1.0, 0.0, 0.0]), np.asarray(0.0))) == 0
