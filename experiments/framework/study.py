"""A study: one question, the configurations that it is asked in, and the functions that answer it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.framework.tables import Row


def _unchanged(config: Any, folder: Path) -> Any:
    return config


def _the_rows(rows: list[Row]) -> list[Row]:
    return rows


@dataclass(frozen=True)
class Study:
    """One question and how it is answered.

    Attributes:
        name: on the command line, and of its files.
        doc: what it shows; the first line is its title.
        sizes: configurations by the name of their size, "full" and "small". Fields that are a number or a string become
            options of the command.
        run: gives the rows of a configuration.
        summary: gives the lines of the printed table, with the paper's number or the target beside ours; by default the
            rows.
        draw: draws the rows of a configuration into a PNG file, and into a PDF beside it (`figures.save`).
        notes: gives Markdown that stands under the table.
        place: gives a configuration the folder of the results, where it writes more than the tables.
        data: what it runs on.
        paper: where the paper has the like of it.
    """

    name: str
    doc: str
    sizes: Mapping[str, Any]
    run: Callable[[Any], list[Row]]
    summary: Callable[[list[Row]], list[Row]] = _the_rows
    draw: Callable[[Any, list[Row], Path], None] | None = None
    notes: Callable[[list[Row]], str] | None = None
    place: Callable[[Any, Path], Any] = _unchanged
    data: str = ""
    paper: str = "–"

    @property
    def title(self) -> str:
        """The first line of its documentation."""
        return self.doc.strip().partition("\n")[0]

    @property
    def text(self) -> str:
        """The rest of its documentation."""
        return self.doc.strip().partition("\n")[2].strip()
