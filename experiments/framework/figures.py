"""Figures of the experiments, each as PNG and as PDF."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def new(width: float, height: float) -> "Figure":
    """A figure of the given size in inches, apart from pyplot: no window, and nothing to close."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save(figure: "Figure", path: Path) -> None:
    """Writes `NAME.png` and `NAME.pdf`; the same figure gives the same bytes."""
    figure.savefig(path.with_suffix(".png"), dpi=110)
    figure.savefig(path.with_suffix(".pdf"), metadata={"CreationDate": None})
