"""Where things are in the checkout."""

from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]

RESULTS = PROJECT / "experiments" / "out"
"""Results that are kept in the repository."""


def results_folder(size: str) -> Path:
    """The default folder for results of a size: small runs never write where the full ones are kept."""
    return RESULTS if size == "full" else RESULTS / size
