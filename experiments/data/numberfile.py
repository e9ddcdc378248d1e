"""Rows of numbers in a text file, read one by one: what is wrong is said with the file and the line."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from symjax.errors import FileFormatError
from symjax.io import parsing


class NumberFile:
    """A text file of numbers parted by white space; blank lines are passed over.

    Raises:
        FileFormatError: the file is not text.
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
        """The numbers of the next row.

        Args:
            count: how many there must be.
            what: they are, for the message.

        Raises:
            FileFormatError: the file has ended, or the row holds something else.
        """
        line = self._line(what)
        try:
            values = np.array([float(cell) for cell in line.split()])
        except ValueError:
            values = np.array([np.nan])
        if len(values) != count or not np.isfinite(values).all():
            raise self.fault(f"{parsing.shown(line)} where {what} was expected, {count} finite numbers")
        return values

    def count(self, what: str) -> int:
        """The whole number, 0 or more, that is the next row."""
        line = self._line(what)
        if not line.strip().isdecimal():
            raise self.fault(f"{parsing.shown(line)} where {what} was expected, a whole number")
        return int(line)

    def finish(self) -> None:
        """Checks that no row is left.

        Raises:
            FileFormatError: there is one.
        """
        if self.more:
            raise self.fault(f"{parsing.shown(self._line(''))} where the file should end")

    @property
    def more(self) -> bool:
        """Whether there is another row."""
        return self._position < len(self._rows)

    def fault(self, message: str) -> FileFormatError:
        """An error about the row read last."""
        number = self._rows[self._position - 1][0] if self._position else 1
        return FileFormatError(f"{self.path}, line {number}: {message}")

    def _line(self, what: str) -> str:
        if not self.more:
            raise self.fault(f"the file ends after it, where {what} was expected")
        self._position += 1
        return self._rows[self._position - 1][1]
