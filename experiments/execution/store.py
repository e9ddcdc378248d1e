"""A file of JSON Lines that is only ever appended to, by one process at a time, and loses nothing to a kill."""

import fcntl
import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any, Self

Item = dict[str, Any]


class Store:
    """The file: what it held when it was opened and what was appended since, one JSON object a line.

    NaN and infinities are written as Python's `json` does and reads: `NaN`, `Infinity`.

    Attributes:
        items: the objects, in the order of the lines.
    """

    def __init__(self, path: Path):
        """Opens or makes the file, and mends its end if a writer was killed within a line.

        Raises:
            RuntimeError: another process writes it.
            ValueError: a line that is not the last is no JSON object.
        """
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("a+b")
        try:
            # the kernel drops the lock with its holder, however that ends
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self.items = self._read()
        except BlockingIOError:
            self._file.close()
            raise RuntimeError(f"{path} is being written by another process") from None
        except ValueError:
            self._file.close()
            raise

    def _read(self) -> list[Item]:
        self._file.seek(0)
        *lines, tail = self._file.read().split(b"\n")
        if tail:
            try:
                _parsed(tail)
            except ValueError:
                self._file.truncate(sum(len(line) + 1 for line in lines))
            else:
                # all of it was written but its end
                lines.append(tail)
                self._write(b"\n")
        items = []
        for number, line in enumerate(lines, 1):
            try:
                items.append(_parsed(line))
            except ValueError as error:
                raise ValueError(f"{self.path}, line {number} is no JSON object: {error}") from None
        return items

    def append(self, item: Item) -> None:
        """Writes an object; on its return the object is on the disk.

        Raises:
            TypeError: a value is no JSON value.
        """
        self._write(json.dumps(item).encode() + b"\n")
        self.items.append(item)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._file.flush()
        os.fsync(self._file.fileno())

    def __enter__(self) -> Self:
        """Itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        """Closes the file and leaves it to other writers."""
        self._file.close()


def _parsed(line: bytes) -> Item:
    item = json.loads(line)
    if not isinstance(item, dict):
        raise ValueError(f"{line[:80]!r}")
    return item
