"""Reads a text file of numbers row by row; errors name the file and the line."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing


class NumberFile:
    """A text file of numbers separated by white space; blank lines are skipped.

    Raises:
        FileFormatError: if the file is not text.
    """

    def __init__(self, path: Path) -> None:
        """Reads the whole file."""
        self.path = path
        try:
            lines = parsing.lines(path.read_bytes())
        except FileFormatError as error:
            raise FileFormatError(f"{path}: {error}") from error
        self._rows = [(number, line) for number, line in enumerate(lines, start=1) if line.strip()]
        self._position = 0

    def row(self, count: int, what: str) -> Float[np.ndarray, " count"]:
        """Reads the next row of numbers.

        Args:
            count: how many numbers the row must have.
            what: what the numbers are, for the error message.

        Raises:
            FileFormatError: if the file has ended or the row is not `count` finite numbers.
        """
        line = self._line(what)
        try:
            values = np.array([float(cell) for cell in line.split()])
        except ValueError:
            values = np.array([np.nan])
        if len(values) != count or not np.isfinite(values).all():
            raise self.error(f"expected {what}, {count} finite numbers, got {parsing.shown(line)}")
        return values

    def count(self, what: str) -> int:
        """Reads the next row as a whole number, 0 or more; `what` describes it in the error message.

        Raises:
            FileFormatError: if the file has ended or the row is anything else.
        """
        line = self._line(what)
        if not line.strip().isdecimal():
            raise self.error(f"expected {what}, a whole number, got {parsing.shown(line)}")
        return int(line)

    def finish(self) -> None:
        """Checks that all rows have been read.

        Raises:
            FileFormatError: if a row is left.
        """
        if self.more:
            raise self.error(f"expected the end of the file, got {parsing.shown(self._line(''))}")

    @property
    def more(self) -> bool:
        """Whether a row is left."""
        return self._position < len(self._rows)

    def error(self, message: str) -> FileFormatError:
        """Returns an error that names the file and the line of the row that was read last."""
        number = self._rows[self._position - 1][0] if self._position else 1
        return FileFormatError(f"{self.path}, line {number}: {message}")

    def _line(self, what: str) -> str:
        if not self.more:
            raise self.error(f"expected {what} after this line, but the file ends")
        self._position += 1
        return self._rows[self._position - 1][1]
