"""The conditions that methods are compared under: named corruptions, and the clouds that result from them.

A cloud is posed first and then corrupted, because a box of outliers along the object's own axes would share its
symmetry.
"""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from experiments.data.cases import Case
from symjax import datasets

CONDITIONS: dict[str, dict[str, Any]] = {
    "clean": {},
    "out20": {"outliers": 0.2},
    "out60": {"outliers": 0.6},
    "out100": {"outliers": 1.0},
    "out300": {"outliers": 3.0},
    "miss15": {"missing": 0.15},
    "miss28": {"missing": 0.28},
    "miss40": {"missing": 0.4},
    "both": {"missing": 0.28, "outliers": 1.0},
    "noise1": {"noise": 0.01},
    "view": {"one_sided": True},
}
"""Arguments of `datasets.corrupt`, by the name of the condition."""

SWEEP_CONDITIONS: dict[str, dict[str, Any]] = CONDITIONS | {
    "out40": {"outliers": 0.4},
    "out80": {"outliers": 0.8},
    "out120": {"outliers": 1.2},
    "miss20": {"missing": 0.2},
}
"""All conditions: those of `CONDITIONS`, and further steps of the sweeps of outliers and of missing parts."""

CONDITION_NAMES = ",".join(CONDITIONS)
"""The names of `CONDITIONS`, as the value of an option `--conditions`."""


class Trial(NamedTuple):
    """A case under a condition.

    Attributes:
        case: the whole object in its pose.
        condition: name of the condition.
        points: the corrupted cloud.
    """

    case: Case
    condition: str
    points: Float[np.ndarray, "m 3"]

    @property
    def about(self) -> dict[str, str | int]:
        """The columns that name the trial."""
        return {
            "condition": self.condition,
            "model": self.case.name,
            "group": self.case.group,
            "seed": self.case.seed,
            "points": len(self.points),
        }


def trials(cases: Iterable[Case], conditions: Iterable[str]) -> Iterator[Trial]:
    """Corrupts all cases by the first condition, then by the second, and so on; every run gives the same clouds."""
    cases = list(cases)
    for condition in conditions:
        for case in cases:
            rng = np.random.default_rng([case.seed, *condition.encode(), *case.name.encode()])
            cloud = datasets.corrupt(case.points, rng, diagonal=case.diagonal, **SWEEP_CONDITIONS[condition])
            yield Trial(case, condition, cloud.points)
