"""What the paper prints of methods on data that is not here, to stand beside what was measured.

Its F-measures are of the 1 354 clouds of Funk et al. 2017, those of partial scans of 20 real ones, and GTE and SDE of
the 1 000 ShapeNet models of PRS-Net. It did not run the methods of the last table itself. Thresholds of F are not
stated.
"""

from collections.abc import Mapping

from experiments.framework.tables import Row

DATA = "Funk 2017, the paper's print"

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
"""F on twenty real partial scans: the condition `view` is the nearest to them here."""

PARTIAL_DATA = "20 real partial scans, the paper's print"

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
"""GTE in 1e-2 and SDE in 1e-4."""

SHAPENET_DATA = "ShapeNet 1000, the paper's print"

SECONDS = {5_000: 2.15, 10_000: 3.67, 50_000: 5.23, 100_000: 8.13, 300_000: 12.92}
"""Of the paper's method by number of points, on the clouds of Funk et al. 2017 and its machine."""

F_TITLE = "F, thresholds not stated"


def lines(printed: Mapping[str, Mapping[str, float]], conditions: list[str], data: str = DATA) -> list[Row]:
    """Printed F as lines of a pivot: those methods that have any of the conditions."""
    return [
        {"data": data, "measure": F_TITLE, "method": f"{method}, printed"} | {c: of.get(c, "") for c in conditions}
        for method, of in printed.items()
        if set(of) & set(conditions)
    ]


def both() -> dict[str, dict[str, float]]:
    """Outliers and missing parts in one."""
    return {method: of | MISSING[method] for method, of in OUTLIERS.items()}
