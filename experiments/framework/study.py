"""A study: one question, the functions that answer it with a table or a figure, and the configurations of both sizes.

To add a study, write a module in a package of `experiments/studies/`. The first line of its docstring is the title on
the page, a sentence; the rest of the docstring says what the rows mean and how they are measured. The module defines a
`Study`:

    @dataclass(frozen=True)
    class Config:
        num_points: int = 10_000
        seed: int = 0

    SIZES = {"full": Config(), "small": Config(num_points=500)}

    def run(config: Config) -> list[Row]:
        return [{"points": config.num_points, "error": ..., "target": "<= 0.01"}]

    STUDY = Study("convergence", __doc__, SIZES, run, data="points drawn on the unit sphere")

and add the line `"convergence": "symhks.convergence:STUDY"` to `experiments.framework.catalogue.STUDIES`. The study is
then a command, `python -m experiments.run convergence --size small --num-points 300`, and has a section on the page.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.framework.tables import Row


def _same_config(config: Any, folder: Path) -> Any:
    return config


def _same_rows(rows: list[Row]) -> list[Row]:
    return rows


@dataclass(frozen=True)
class Study:
    """One question and how it is answered.

    Attributes:
        name: name of the study on the command line, in the catalogue and in its file names.
        doc: description for the page, usually `__doc__` of the module; its first line is the title, a sentence.
        sizes: configurations for "full" (the numbers that are kept) and "small" (seconds, for the tests). A
            configuration is a frozen dataclass; its fields that are a number or a string become options of the command.
        run: computes the rows from a configuration; written as CSV. Rows of one study have the same columns. Raises
            `DataAbsentError` if the data is absent.
        summary: computes the lines of the printed table from the rows, with the paper's number or the target beside
            ours; by default the rows themselves.
        draw: draws the figure from the configuration and the rows, and saves it as the given PNG file and as PDF
            (`figures.save`); None if the study has no figure.
        notes: returns Markdown text that is appended to the table; None if there is none.
        place: returns the configuration with the folder of the results filled in, for a study that writes or reads
            more files there; by default the configuration as it is.
        data: what the study runs on, for the page (`experiments.data` has the usual phrases).
        paper: the part of the paper that the study corresponds to, for the page.
    """

    name: str
    doc: str
    sizes: Mapping[str, Any]
    run: Callable[[Any], list[Row]]
    summary: Callable[[list[Row]], list[Row]] = _same_rows
    draw: Callable[[Any, list[Row], Path], None] | None = None
    notes: Callable[[list[Row]], str] | None = None
    place: Callable[[Any, Path], Any] = _same_config
    data: str = ""
    paper: str = "–"

    @property
    def title(self) -> str:
        """The first line of the description."""
        return self.doc.strip().partition("\n")[0]

    @property
    def text(self) -> str:
        """The description without its first line."""
        return self.doc.strip().partition("\n")[2].strip()
