"""Every experiment runs at its smallest size and leaves rows, provenance and, where it has one, a picture."""

import csv
import dataclasses
import importlib
import json

import numpy as np
import pytest

from experiments.framework import study
from experiments.framework.catalogue import CONTENTS, script

ONE_OBJECT = ["--objects", "1", "--num-points", "300", "--methods", "pca", "--jobs", "1"]

TINY = {
    "ablation": ["--conditions", "both", "--stages", "nothing,neutral rim"],
    "arena": ONE_OBJECT,
    "articulated": ["--num-points", "3000"],
    "calibration": ["--conditions", "clean", "--data", "absent"],
    "completion": ["--kinds", "quadruped", "--num-points", "800", "--methods", "robust"],
    "coverage": ["--clouds", "2"],
    "deviation": ["--trials", "2"],
    "equivariance": ["--kinds", "1", "--methods", "robust"],
    "gradient": ["--fits", "fit_plane newton", "--num-pairs", "60"],
    "growth": ["--sizes", "300,600", "--methods", "pca,3dsymm-all"],
    "gte_sde": ONE_OBJECT,
    "landscape": [],
    "missing": ONE_OBJECT,
    "outliers": ONE_OBJECT,
    "partial_scans": ONE_OBJECT,
    "planted": ["--trials", "2", "--exact-trials", "1"],
    "precision_recall": ONE_OBJECT,
    "road": ["--kinds", "1", "--data", "absent"],
    "robustness": [
        *("--methods", "robust,sym-hks-cleaned", "--kinds", "1"),
        *("--conditions", "out100", "--data", "absent"),
    ],
    "self_scale": ["--num-pairs", "100", "--seeds", "1", "--trials", "2", "--trial-pairs", "100"],
    "scale": ["--repeats", "1", "--memory-points", "0"],
    "speed_fit": ["--sizes", "100", "--restarts", "2", "--repeats", "1"],
    "speed_objective": ["--num-pairs", "100", "--planes", "8", "--repeats", "1"],
    "speed_sweep": [
        *("--num-pairs", "100", "--scales", "1", "--restarts", "8", "--repeats", "1"),
        *("--memory-pairs", "100", "--memory-restarts", "8"),
    ],
    "sphere": [],
    "success": ["--sizes", "100", "--seeds", "1", "--restarts", "4"],
    "sym_hks_ablation": ["--choices", "starts", "--conditions", "out20 dropped", "--num-points", "600"],
    "start_angle": [
        *("--angles", "0,60", "--kinds", "1", "--num-points", "800"),
        *("--conditions", "clean", "--outliers", "0.65"),
    ],
    "timing": ["--repeats", "1"],
}
CHECKS = ("checks", "transformations")
DRAWN = (
    *("arena", "articulated", "completion", "deviation", "growth", "landscape", "missing"),
    *("outliers", "precision_recall", "start_angle", "sym_hks_ablation"),
)


def test_all_experiments_of_the_contents_are_there_and_run_here():
    assert set(TINY) | set(CHECKS) == set(CONTENTS)
    assert [name for name in CONTENTS if not script(name).is_file()] == []


@pytest.mark.parametrize("name", TINY)
def test_an_experiment_runs_and_says_where_its_rows_come_from(name, tmp_path, capsys):
    module = importlib.import_module(f"experiments.{name}")
    module.main(["--size", "small", "--out", str(tmp_path), *TINY[name]])
    with (tmp_path / f"{name}.csv").open() as file:
        assert len(list(csv.DictReader(file))) >= 1
    about = json.loads((tmp_path / f"{name}.json").read_text())
    assert about["command"].startswith(f"python -m experiments.{name} --size small")
    assert {"config", "commit", "versions", "machine", "wall_seconds", "summary"} <= set(about)
    if name in DRAWN:
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000
        assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    assert f"{name} (small)" in capsys.readouterr().out


@pytest.mark.parametrize("name", CHECKS)
def test_the_checks_meet_their_targets(name, tmp_path):
    module = importlib.import_module(f"experiments.{name}")
    module.main(["--size", "small", "--out", str(tmp_path), "--problems", "2"])
    with (tmp_path / f"{name}.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) > 8
    assert [row["check"] for row in rows if row["passed"] != "True"] == []


def test_the_estimator_withstands_what_the_baseline_does_not():
    from experiments.studies.paper import deviation

    config = dataclasses.replace(deviation.SIZES["small"], shares=(0.65,), blobs=("isotropic",))
    rows = deviation.run(config)
    median = {
        method: np.median([r["angle"] for r in rows if r["method"] == method and r["outliers"] == "beside"])
        for method in deviation.METHODS
    }
    assert median["L2E, 64 starts"] < 1.0
    assert median["L2"] > 5 * median["L2E, 64 starts"]


def test_absent_data_is_said_loudly(capsys):
    from pathlib import Path

    from experiments.data import cases

    assert list(cases.real(Path("absent"), 100, 1)) == []
    assert "ABSENT" in capsys.readouterr().err


def test_real_models_are_posed_with_their_planes(models):
    from experiments.data import cases

    for case in cases.real(models.parent, 400, 1):
        for plane in case.planes:
            assert np.linalg.norm(plane.normal) == pytest.approx(1.0, abs=1e-6)
            # a mirror plane passes through the middle of its object
            middle = case.points.mean(axis=0)
            assert abs(plane.signed_distance(middle[None])[0]) < 0.1 * case.diagonal


def test_nothing_is_written_where_nothing_was_measured(tmp_path, capsys):
    @dataclasses.dataclass(frozen=True)
    class Config:
        seed: int = 0

    with pytest.raises(SystemExit) as stop:
        study.main(
            "none.py", "Nothing.", {"full": Config()}, lambda _: [], lambda rows: rows, argv=["--out", str(tmp_path)]
        )
    assert stop.value.code == study.NOT_MEASURED
    assert "NOTHING WAS MEASURED" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
