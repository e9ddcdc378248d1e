"""All studies, in the order of the page. A new study becomes a command by one more line in `STUDIES`.

A study is imported only when it is run or listed, so that one study's missing dependency does not stop the others.
"""

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
"""`module:attribute` of every study, relative to `experiments.studies`, by its name on the command line.

The key and the `name` of the `Study` must be the same.
"""


def load(name: str) -> Study:
    """Imports and returns the study of a name."""
    module, _, attribute = STUDIES[name].partition(":")
    study: Study = getattr(importlib.import_module(f"experiments.studies.{module}"), attribute)
    return study
