"""Matplotlib figures of the studies, each saved as PNG and as PDF."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def new(width: float, height: float) -> "Figure":
    """Returns an empty figure; width and height are in inches.

    The figure is not registered with pyplot: it opens no window and need not be closed.
    """
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save(figure: "Figure", path: Path) -> None:
    """Writes the figure as `NAME.png` and `NAME.pdf`; the same figure gives the same bytes."""
    figure.savefig(path.with_suffix(".png"), dpi=110)
    figure.savefig(path.with_suffix(".pdf"), metadata={"CreationDate": None})
