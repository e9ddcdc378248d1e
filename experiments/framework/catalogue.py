"""The studies in the order in which they are presented; each is imported when it is asked for."""

import importlib

from experiments.framework.study import Study

STUDIES = {
    "landscape": "paper.landscape:STUDY",
    "deviation": "paper.deviation:STUDY",
    "planted": "estimator.planted:STUDY",
    "start_angle": "paper.start_angle:STUDY",
    "arena": "paper.arena:STUDY",
    "precision_recall": "paper.sweeps:PRECISION_RECALL",
    "outliers": "paper.sweeps:OUTLIERS",
    "missing": "paper.sweeps:MISSING",
    "robustness": "robust.robustness:STUDY",
    "gte_sde": "paper.sweeps:GTE_SDE",
    "partial_scans": "paper.sweeps:PARTIAL_SCANS",
    "completion": "paper.completion:STUDY",
    "articulated": "paper.articulated:STUDY",
    "growth": "paper.growth:STUDY",
    "scale": "speed.scale:STUDY",
    "sym_hks_ablation": "symhks.ablation:STUDY",
    "ablation": "robust.ablation:STUDY",
    "calibration": "robust.calibration:STUDY",
    "coverage": "robust.coverage:STUDY",
    "equivariance": "robust.equivariance:STUDY",
    "sphere": "symhks.sphere:STUDY",
    "gradient": "estimator.gradient:STUDY",
    "success": "estimator.success:STUDY",
    "self_scale": "estimator.self_scale:STUDY",
    "speed_objective": "speed.objective:STUDY",
    "speed_fit": "speed.fit:STUDY",
    "speed_sweep": "speed.sweep:STUDY",
}
"""Modules of `experiments.studies`, and the names of the studies in them, by the name on the command line."""


def load(name: str) -> Study:
    """The study of a name."""
    module, _, attribute = STUDIES[name].partition(":")
    return getattr(importlib.import_module(f"experiments.studies.{module}"), attribute)
