"""Numbers that the paper publishes, for comparison with our measurements; they were obtained on other data.

The F-measures are for the 1 354 clouds of Funk et al. 2017 and, for partial scans, for 20 real ones. GTE and SDE are
for the 1 000 ShapeNet models of PRS-Net; the authors did not run the other methods of that table themselves. The paper
does not state the thresholds of F.
"""

from collections.abc import Mapping

from experiments.framework.tables import Row

DATA = "Funk 2017, published in the paper"

OUTLIERS = {
    "the paper": {"clean": 0.95, "out20": 0.94, "out40": 0.92, "out60": 0.91, "out80": 0.91, "out100": 0.89},
    "3DSymm": {"clean": 0.90, "out20": 0.87, "out40": 0.86, "out60": 0.86, "out80": 0.85, "out100": 0.85},
}
"""F by method and condition."""

MISSING = {
    "the paper": {"clean": 0.95, "miss15": 0.93, "miss20": 0.92, "miss28": 0.90},
    "3DSymm": {"clean": 0.90, "miss15": 0.82, "miss20": 0.75, "miss28": 0.67},
}

PARTIAL = {"the paper": {"view": 0.96}, "Hruda": {"view": 0.93}, "Nagar and Raman": {"view": 0.90}}
"""F on twenty real partial scans. Our condition `view` is the most similar."""

PARTIAL_DATA = "20 real partial scans, published in the paper"

GTE_SDE = {
    "the paper": (0.13, 0.89),
    "PRS-Net": (0.11, 0.86),
    "PCA": (2.41, 3.32),
    "Kazhdan": (0.17, 0.897),
    "Martinet": (13.6, 3.95),
    "Mitra": (52.1, 14.2),
    "PRST": (4.42, 1.78),
    "Korman": (19.2, 1.75),
    "RANSAC": (1.53, 2.31),
}
"""GTE in units of 1e-2 and SDE in units of 1e-4."""

SHAPENET_DATA = "ShapeNet 1000, published in the paper"

SECONDS = {5_000: 2.15, 10_000: 3.67, 50_000: 5.23, 100_000: 8.13, 300_000: 12.92}
"""Run time of the paper's method by number of points, on the clouds of Funk et al. 2017 and the authors' machine."""

F_TITLE = "F, thresholds not stated"


def lines(numbers: Mapping[str, Mapping[str, float]], conditions: list[str], data: str = DATA) -> list[Row]:
    """Formats published F as lines of `leaderboard.pivot`, for the methods that have any of the conditions."""
    return [
        {"data": data, "measure": F_TITLE, "method": f"{method}, published"}
        | {condition: values.get(condition, "") for condition in conditions}
        for method, values in numbers.items()
        if set(values) & set(conditions)
    ]


def outliers_and_missing() -> dict[str, dict[str, float]]:
    """Merges `OUTLIERS` and `MISSING`."""
    return {method: values | MISSING[method] for method, values in OUTLIERS.items()}
