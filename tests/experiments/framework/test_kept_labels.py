"""Kept results have the labels that the code writes today, so that they can be compared with new results."""

import json
import re

import pytest

from experiments.baselines.registry import ENTRIES
from experiments.comparison import published
from experiments.comparison.leaderboard import MEASURES
from experiments.framework.project import RESULTS
from experiments.studies.paper.growth import METHODS
from experiments.studies.robust.ablation import SHARES, STAGES
from experiments.studies.robust.calibration import DISAGREEMENT, GRIDS, RATES
from experiments.studies.symhks.choices import CHOICES
from symjax.l2e.solvers.names import SOLVER_NAMES

TITLES = {entry.title for entry in (ENTRIES | METHODS).values()}


def lines(study):
    return json.loads((RESULTS / f"{study}.json").read_text(encoding="utf-8"))["summary"]


def column(study, name):
    return {line[name] for line in lines(study)}


@pytest.mark.parametrize(
    "study", ["arena", "outliers", "missing", "partial_scans", "gte_sde", "precision_recall", "growth"]
)
def test_methods_and_measures_of_the_comparison(study):
    names = {name for name in column(study, "method") if not name.endswith(", published")}
    assert names <= TITLES
    if "measure" in lines(study)[0]:
        assert column(study, "measure") <= {measure.title for measure in MEASURES.values()} | {published.F_TITLE}
        paper = {line["data"] for line in lines(study) if line["measure"] == published.F_TITLE}
        assert paper <= {published.DATA, published.PARTIAL_DATA}


def test_stages_of_the_ablation():
    assert column("ablation", "without") <= set(STAGES)
    assert column("ablation", "share of") == set(SHARES.values())


def test_rates_and_thresholds_of_the_calibration():
    assert {title for title, _, _ in RATES} < set(lines("calibration")[0])
    labels = column("calibration", "clouds of")
    assert DISAGREEMENT in labels
    thresholds = {re.sub(r" \d\.\d\d", "", label) for label in labels}
    assert {", ".join(grid) for grid in GRIDS} <= thresholds


def test_choices_of_sym_hks():
    for line in lines("sym_hks_ablation"):
        assert line["value"] in CHOICES[line["choice"]]
    assert {"failed", "clean: correct pairs"} < set(lines("sym_hks_ablation")[0])


def test_solvers_and_columns():
    solvers = {case.split(", ")[1] for case in column("success", "case") if case.startswith("fibonacci, ")}
    assert solvers <= set(SOLVER_NAMES)
    assert {"correct", "correct if unambiguous"} < set(lines("robustness")[0])
    for study in ("speed_sweep", "self_scale", "sphere"):
        assert "quantity" in lines(study)[0]
