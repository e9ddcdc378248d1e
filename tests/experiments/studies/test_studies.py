"""Every study runs at its smallest size and writes rows, provenance and, if it has one, a figure."""

import csv
import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from experiments.data import cases
from experiments.framework.catalogue import STUDIES, load
from experiments.framework.run_study import run_study
from experiments.studies.paper import deviation

ONE_OBJECT = ["--objects", "1", "--num-points", "300", "--methods", "pca", "--jobs", "1"]

TINY = {
    "ablation": ["--conditions", "both", "--stages", "nothing,neutral boundary"],
    "arena": ONE_OBJECT,
    "articulated": ["--num-points", "3000"],
    "calibration": ["--conditions", "clean", "--data", "absent"],
    "completion": ["--kinds", "quadruped", "--num-points", "800", "--methods", "robust"],
    "coverage": ["--clouds", "2"],
    "deviation": ["--trials", "1", "--num-pairs", "200"],
    "equivariance": ["--kinds", "1", "--methods", "robust"],
    "gradient": ["--fits", "fit_plane newton", "--num-pairs", "60"],
    "growth": ["--sizes", "300,600", "--methods", "pca,3dsymm-all"],
    "gte_sde": ONE_OBJECT,
    "landscape": ["--num-pairs", "200"],
    "missing": ONE_OBJECT,
    "outliers": ONE_OBJECT,
    "partial_scans": ONE_OBJECT,
    "planted": ["--trials", "1", "--exact-trials", "1", "--num-pairs", "200"],
    "precision_recall": ONE_OBJECT,
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
    "sym_hks_ablation": ["--choices", "signs (0: off)", "--conditions", "out20 dropped", "--num-points", "600"],
    "start_angle": [
        *("--angles", "0,60", "--kinds", "1", "--num-points", "800"),
        *("--conditions", "clean", "--outliers", "0.65"),
    ],
}
SLOW = ("gradient", "planted", "self_scale", "speed_fit", "speed_objective", "speed_sweep", "success")
"""Studies whose fits compile for half a minute each."""

DRAWN = (
    *("arena", "articulated", "completion", "deviation", "growth", "landscape", "missing"),
    *("outliers", "precision_recall", "start_angle", "sym_hks_ablation"),
)


def rows_of(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_every_study_has_tiny_options():
    assert set(TINY) == set(STUDIES)
    assert {name for name in STUDIES if load(name).draw} == set(DRAWN)


@pytest.mark.parametrize("name", [pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in TINY])
def test_a_study_runs_and_writes_rows_and_provenance(name, tmp_path, capsys):
    assert run_study(load(name), ["--size", "small", "--out", str(tmp_path), *TINY[name]]) == 0
    assert len(rows_of(tmp_path / f"{name}.csv")) >= 1
    about = json.loads((tmp_path / f"{name}.json").read_text())
    assert about["command"].startswith(f"python -m experiments.run {name} --size small")
    assert {"config", "commit", "versions", "machine", "wall_seconds", "summary"} <= set(about)
    if name in DRAWN:
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000
        assert (tmp_path / f"{name}.pdf").read_bytes().startswith(b"%PDF")
    assert f"{name} (small)" in capsys.readouterr().out


def test_l2e_tolerates_outliers_beside_the_object_and_l2_does_not():
    config = dataclasses.replace(deviation.SIZES["small"], shares=(0.65,), blobs=("isotropic",))
    rows = deviation.run(config)
    median = {
        method: np.median([r["angle"] for r in rows if r["method"] == method and r["outliers"] == "beside"])
        for method in deviation.METHODS
    }
    assert median["L2E, 64 starts"] < 1.0
    assert median["L2"] > 5 * median["L2E, 64 starts"]


def test_a_missing_data_folder_gives_a_message(capsys):
    assert list(cases.real_cases(Path("absent"), 100, 1)) == []
    assert "ABSENT" in capsys.readouterr().err


def test_real_models_are_posed_with_their_planes(models):
    for case in cases.real_cases(models.parent, 400, 1):
        for plane in case.planes:
            assert np.linalg.norm(plane.normal) == pytest.approx(1.0, abs=1e-6)
            # a mirror plane passes near the mean of the points
            centre = case.points.mean(axis=0)
            assert abs(plane.signed_distance(centre[None])[0]) < 0.1 * case.diagonal
