"""The arena: methods answer in one form, rows make the tables that they should, and a run goes on where it was."""

import json

import numpy as np
import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")

from scipy.spatial import KDTree

import symjax
from experiments.baselines import registry
from experiments.baselines.registry import ENTRIES, OURS, PEER
from experiments.comparison import answers, evaluate, objects, plan, published
from experiments.comparison.curves import precision_recall, shares
from experiments.comparison.leaderboard import MEASURES, answered, best_f, pivot, standing, standings, tallies
from experiments.comparison.shortcomings import sentences
from experiments.comparison.tracks import TRACKS
from experiments.data import corruptions, procedural
from experiments.data.absence import DataAbsentError
from experiments.data.cases import made
from experiments.data.shape import Shape
from experiments.execution.result import Result
from experiments.metrics import ranked
from experiments.metrics.answered import Answered
from experiments.studies.paper import arena, outliers
from symjax.geometry.plane import Plane
from symjax.io.mesh import Mesh

SLOW = ("robust", "sym-hks-printed", "sym-hks", "sym-hks-cleaned", "3dsymm-26", "hruda", PEER)
"""Methods that have tests of their own, or compile for seconds."""

TINY = [
    *("--size", "small", "--num-points", "300", "--jobs", "1"),
    *("--methods", "pca,ransac-released,cicconet", "--conditions", "clean,out40"),
]


def row(method="pca", item=0, condition="clean", angle=1.0, offset=0.0, **changed):
    """A row of one truth, x = 0, and one answer that is so far from it."""
    turned = np.radians(angle)
    steps = range(evaluate.STEPS + 1)
    made_up = {
        **{"method": method, "benchmark": "procedural", "item": item, "condition": condition, "seed": 0},
        **{"num_points": 100, "data": "", "name": "block", "group": "generated", "raised": "", "seconds": 2.0},
        **{"truths": [[1.0, 0.0, 0.0, 0.0]], "centre": [0.0, 0.0, 0.0], "diagonal": 1.0},
        "planes": [[np.cos(turned), np.sin(turned), 0.0, offset, 0.9]],
        **{"held": [True], "found": True, "ambiguous": False, "angle": angle, "offset_error": offset},
        **{"gte": 0.02, "gte_squared": 4e-4, "sde": 3e-4},
        **{"funk": [int(angle < step) for step in steps], "funk_paper": [int(angle < step) for step in steps]},
    }
    return made_up | changed


def silent(**changed):
    return row(**changed) | evaluate.NO_ANSWER | {"raised": "timeout: more than 9 s"}


@pytest.fixture(scope="module")
def boat():
    return made("boat", 700, 3)


@pytest.mark.parametrize("method", [name for name in ENTRIES if name not in SLOW])
def test_a_method_ranks_unit_planes_by_falling_scores(method, boat):
    ranking, held, _ = ENTRIES[method].propose(boat.points, np.random.default_rng(0))
    assert len(ranking.scores) == len(held) >= 1
    np.testing.assert_allclose(np.linalg.norm(ranking.normals, axis=1), 1.0, atol=1e-12)
    assert (np.diff(ranking.scores) <= 0).all()
    largest = np.take_along_axis(ranking.normals, np.abs(ranking.normals).argmax(axis=1)[:, None], axis=1)
    assert (largest > 0).all()
    assert held[0]
    assert held[1:].all() or not held[1:].any()


def test_ours_holds_what_it_takes_for_mirror_planes(boat):
    said = ENTRIES[OURS].propose(boat.points, np.random.default_rng(0))
    direct = symjax.detect(boat.points, rng=np.random.default_rng(0))
    assert said.ranking.plane().angle(direct.plane) == 0
    assert said.held.sum() == len(direct.planes)
    assert (len(said.held), said.found) == (len(direct.candidates), direct.found)
    assert (np.diff(said.ranking.scores) <= 0).all()
    one = answers.answer(OURS, boat.points)
    assert (one.found, one.error) == (direct.found, "")
    assert one.plane.angle(direct.plane) < 1e-9


def test_methods_that_are_judged_as_they_stand_are_of_the_arena():
    assert set(answers.METHODS) <= set(ENTRIES)
    failed = answers.answer("sym-hks", np.zeros((5, 3)))
    assert failed.plane is None
    assert not failed.found
    assert "Error" in failed.error


def test_a_package_that_is_absent_is_said_loudly(monkeypatch, capsys):
    monkeypatch.setattr(registry.importlib.util, "find_spec", lambda name: None)
    assert registry.usable(["pca", PEER]) == ["pca"]
    assert "PYCLARCS IS NOT INSTALLED" in capsys.readouterr().err


def test_the_sweeps_add_conditions_and_leave_the_others_alone():
    assert ",".join(corruptions.CONDITIONS) == corruptions.ALL
    assert set(corruptions.TARGETS) == set(corruptions.CONDITIONS)
    every = plan.ALL.split(",")
    assert len(every) == len(set(every)) == 14
    assert list(shares(every, "outliers").values()) == [0, 20, 40, 60, 80, 100, 120]
    assert list(shares(every, "missing").values()) == pytest.approx([0, 15, 20, 28, 40])


def test_the_dense_sample_is_of_the_same_surface_and_holds_none_of_the_points():
    case, dense, truths = objects.entrant("procedural", "", 4, 0, 500)
    assert truths is None
    assert (len(case.points), len(dense)) == (500, objects.DENSE)
    apart = KDTree(dense).query(case.points)[0]
    assert apart.min() > 0
    assert apart.max() < 0.05 * case.diagonal


def test_other_numbers_and_seeds_are_other_objects():
    one, again, other, seed = (
        objects.entrant("procedural", "", item, s, 200).case for item, s in ((2, 0), (2, 0), (3, 0), (2, 1))
    )
    np.testing.assert_array_equal(one.points, again.points)
    assert one.name != other.name
    assert one.name == seed.name
    assert not np.allclose(one.points, seed.points)


def test_items_are_those_with_a_plane(models):
    folder = str(models.parent)
    names = objects.items("folder", folder, 3)
    assert list(names) == [0, 1, 2]
    whole = objects.entrant("folder", folder, 2, 1, 300)
    assert whole.case.name == names[2]
    image = whole.case.planes[0].reflect(whole.case.points)
    assert KDTree(whole.dense).query(image)[0].max() < 0.05 * whole.case.diagonal
    assert objects.entrant("folder", folder, 0, 1, 300).case.name != whole.case.name


def test_absent_data_is_said_loudly(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(objects, "MODELS", tmp_path)
    assert objects.items("real", "", 3) == {}
    assert "REAL MODELS ARE ABSENT" in capsys.readouterr().err
    with pytest.raises(DataAbsentError, match="DATA IS ABSENT"):
        objects.items("funk", str(tmp_path / "none"), 3)


def test_a_row_is_json_and_depends_on_nothing_but_the_task():
    arguments = ("cicconet", "procedural", 1, procedural.kind(1), "out40", 0, 300)
    first, second = evaluate.compete(*arguments), evaluate.compete(*arguments)
    assert first.pop("seconds") > 0
    second.pop("seconds")
    assert json.loads(json.dumps(first, allow_nan=False)) == second
    assert first["gte_squared"] == pytest.approx(first["gte"] ** 2)
    assert first["funk_paper"][-1] == (first["angle"] < 45)


def test_a_method_that_raises_has_given_no_answer(monkeypatch):
    def fails(points, rng):
        raise ValueError("no plane")

    monkeypatch.setitem(ENTRIES, "pca", registry.Entry("PCA", fails))
    said = evaluate.compete("pca", "procedural", 0, procedural.kind(0), "clean", 0, 200)
    assert (said["angle"], said["planes"], said["raised"]) == (90.0, [], "ValueError('no plane')")
    assert len(said["truths"]) >= 1


def test_another_object_in_the_place_of_one_is_refused():
    with pytest.raises(ValueError, match="is 'sofa' and not 'chair'"):
        evaluate.compete("pca", "procedural", 1, "chair", "clean", 0, 200)


def test_the_papers_algorithm_as_printed_is_another_than_with_our_choices(boat):
    printed, ours = (
        ENTRIES[name].propose(boat.points, np.random.default_rng(0)).ranking for name in ("sym-hks-printed", "sym-hks")
    )
    # one start, and so one plane
    assert len(printed.offsets) == 1 < len(ours.offsets)


def test_objects_with_an_axis_or_without_a_plane_are_left_out_loudly(capsys, monkeypatch, tmp_path):
    cloud = Shape("a", "group", Mesh(np.eye(3), np.empty((0, 3), int), 0), (), 1.0)
    plane, axis = Plane(np.eye(3)[0], np.asarray(0.0)), (np.zeros(3), np.eye(3)[0])
    shapes = [cloud, cloud._replace(name="b", planes=(plane,)), cloud._replace(name="c", planes=(plane,), axis=axis)]
    monkeypatch.setitem(objects.LOADERS, "ycb", lambda folder: iter(shapes))
    assert objects.items("ycb", str(tmp_path), 9) == {1: "b"}
    assert "ycb: 2 OF 3 OBJECTS" in capsys.readouterr().err


def test_a_row_scores_as_the_case_that_it_is_of(boat):
    ranking = ENTRIES["kazhdan"].propose(boat.points, np.random.default_rng(0)).ranking
    told = row(
        planes=np.column_stack(ranking).tolist(),
        truths=[[*p.normal.tolist(), float(p.offset)] for p in boat.planes],
        centre=boat.points.mean(axis=0).tolist(),
        diagonal=boat.diagonal,
    )
    for ours, theirs in zip(ranked.curve([answered(told)]), ranked.curve([Answered(ranking, boat)]), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_figures_of_known_rows():
    rows = [row(item=0, angle=1.0), row(item=1, angle=4.0, offset=0.03), row(item=2, angle=30.0), silent(item=3)]
    said = standing(rows)
    assert (said["objects"], said["answered"], said["found"]) == (4, 3, 3)
    assert said["hit rate"] == 0.25
    assert [said[f"hit rate {degrees}"] for degrees in (1, 2, 10, 45)] == [0.0, 0.25, 0.25, 0.5]
    assert said["F paper"] == pytest.approx(2 * 2 / (3 + 4))
    assert said["median angle"] == pytest.approx((4 + 30) / 2)
    assert said["area"] == pytest.approx((44 / 45 + 15 / 45) / 4)
    assert (said["GTE"], said["GTE squared"], said["SDE"]) == pytest.approx((2.0, 0.04, 3.0))
    assert said["seconds"] == 2.0


def test_planes_that_are_not_held_do_not_count_as_false():
    two = [[1.0, 0.0, 0.0, 0.0, 0.9], [0.0, 1.0, 0.0, 0.0, 0.5]]
    both, first = row(planes=two, held=[True, True]), row(planes=two, held=[True, False])
    assert tallies([both], "funk")[-1].precision == 0.5
    assert tallies([first], "funk")[-1].precision == 1.0
    # a threshold on the score leaves the second out as well
    assert best_f([both]) == 1.0
    assert best_f([silent()]) == 0.0
    other = row(item=1, planes=[[1.0, 0.0, 0.0, 0.0, 0.4]])
    # 0.5 of the false one is more than 0.4 of the right one
    assert best_f([both, other]) == pytest.approx(0.8)
    assert best_f([both, other], 1) == 1.0


def test_published_measures_are_of_the_planes_that_are_held():
    true, wrong = [1.0, 0.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 0.0, 0.9]
    truths = [true[:4], [0.0, 0.0, 1.0, 0.0]]
    one = standing([row(planes=[wrong, true], held=[False, True], truths=truths)])
    assert (one["PHC"], one["mAP"], one["mAP of truths"]) == (1.0, 1.0, 0.5)
    assert one["F coarse"] == pytest.approx(2 / 3)
    # at a threshold of 0 nothing matches
    assert one["F E3Sym"] == pytest.approx(2 / 3 * 200 / 201)
    both = standing([row(planes=[wrong, true], held=[True, True], truths=truths)])
    assert (both["PHC"], both["mAP"], both["mAP of truths"]) == (0.0, 0.5, 0.25)
    nothing = standing([silent()])
    assert [nothing[name] for name in TRACKS] == [0.0] * len(TRACKS)


def test_what_a_limit_ended_is_a_miss_on_the_object_of_the_others():
    task = {
        name: row()[name] for name in ("method", "benchmark", "item", "name", "condition", "seed", "num_points", "data")
    }
    done = {name: value for name, value in row(truths=[[1.0, 0, 0, 0], [0, 1.0, 0, 0]]).items() if name not in task}
    ok = Result("a", task, "ok", done, "", 1.0, "host")
    hung = Result("b", task | {"method": "hruda"}, "timeout", {}, "more than 9 s", 9.1, "host")
    alone = Result("c", task | {"item": 7}, "died", {}, "killed", 3.0, "host")
    absent = Result("d", task | {"item": 8}, "error", {}, "DATA IS ABSENT", 0.1, "host")
    one, two, three = plan.rows_of([ok, hung, alone, absent])
    assert two["truths"] == one["truths"]
    assert (two["angle"], two["seconds"], two["raised"]) == (90.0, 9.1, "timeout: more than 9 s")
    assert len(three["truths"]) == 1
    assert standing([two, three])["hit rate"] == 0.0


def test_the_table_has_methods_by_conditions():
    rows = [row(m, i, c) for i in range(2) for c in ("clean", "out20") for m in ("pca", "hruda")]
    lines = standings(rows)
    assert [(line["condition"], line["method"]) for line in lines] == [
        (c, m) for c in ("clean", "out20") for m in ("pca", "hruda")
    ]
    table = pivot(lines, ["hit rate", "seconds"])
    assert [(line["method"], line["clean"], line["out20"]) for line in table] == [
        *(("PCA", 1.0, 1.0), ("after Hruda", 1.0, 1.0)),
        *(("PCA", 2.0, 2.0), ("after Hruda", 2.0, 2.0)),
    ]


def test_a_sentence_says_where_ours_is_not_first():
    lines = standings([row(OURS, seconds=3.0), row("pca"), row(OURS, 1, angle=40.0, seconds=3.0), row("pca", 1)])
    said = sentences(lines, {name: MEASURES[name] for name in ("hit rate", "GTE", "seconds")})
    assert said[0] == "symjax's default is first or tied in 1 of 3 columns."
    assert len(said) == 3
    assert "symjax has 0.5, and PCA has 1;" in said[1]
    assert "symjax has 3, and PCA has 2;" in said[2]
    for sde, sentence in ((2.95, "1 of 1"), (2.7, "0 of 1")):
        lines = standings([row(OURS), row("pca", sde=sde * 1e-4)])
        assert sentence in sentences(lines, {"SDE": MEASURES["SDE"]})[0]
    assert "nothing to compare" in sentences(standings([row("pca"), row("hruda")]))[0]


def test_the_papers_curve_is_a_diagonal_and_the_score_tells_right_from_wrong():
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


def test_what_is_printed_stands_beside_what_is_measured():
    lines = published.lines(published.both(), ["clean", "out100", "noise1"])
    assert lines[0]["method"] == "the paper, printed"
    assert (lines[0]["clean"], lines[0]["out100"], lines[0]["noise1"]) == (0.95, 0.89, "")
    assert "Funk 2017" in lines[0]["data"]
    assert published.lines(published.PARTIAL, ["clean"]) == []


def stripped(path):
    """The lines of a file of results in any order, timings and machine aside."""
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    for line in lines:
        del line["seconds"], line["row"]["seconds"]
    return sorted(json.dumps(line, sort_keys=True) for line in lines)


def test_the_command_goes_on_where_it_was_and_the_other_scripts_from_there(tmp_path, capsys):
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    arena.main([*TINY, "--objects", "2", "--out", str(whole)])
    arena.main([*TINY, "--objects", "1", "--out", str(broken)])
    results = broken / plan.RESULTS
    kept = results.read_bytes()
    assert kept.count(b"\n") == 6
    # killed within the last line
    results.write_bytes(kept[:-40])
    plan.outcomes.cache_clear()
    arena.main([*TINY, "--objects", "2", "--out", str(broken)])
    assert results.read_bytes().startswith(kept[: kept[:-1].rindex(b"\n") + 1])
    assert stripped(results) == stripped(whole / plan.RESULTS)
    done = results.read_bytes()
    for script in (arena, outliers):
        plan.outcomes.cache_clear()
        script.main([*TINY, "--objects", "2", "--out", str(broken)])
        assert results.read_bytes() == done
        name = script.__name__.split(".")[-1]
        assert "the paper, printed" in (broken / f"{name}.md").read_text()
        assert (broken / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    text = (broken / "arena.md").read_text()
    assert "procedural-1354 (2 objects)" in text
    assert all(measure.title in text for measure in MEASURES.values())
    assert "arena (small)" in capsys.readouterr().out


def test_truths_of_a_row_are_planes():
    plane = answered(row()).case.planes[0]
    assert plane.angle(Plane(np.array([1.0, 0.0, 0.0]), np.asarray(0.0))) == 0
