"""Folders of the checkout."""

from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]

RESULTS = PROJECT / "experiments" / "out"
"""Folder of the results that are kept in the repository."""


def results_folder(size: str) -> Path:
    """Returns the default folder for results of a size; small runs never write into the folder of the full ones."""
    return RESULTS if size == "full" else RESULTS / size
