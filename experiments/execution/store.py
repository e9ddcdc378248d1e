"""An append-only file of JSON Lines with one writer at a time, which loses no finished line if the writer is killed."""

import fcntl
import json
import os
from pathlib import Path
from types import TracebackType
from typing import Any, Self

Item = dict[str, Any]


class Store:
    """The open file, one JSON object per line.

    NaN and infinities are written in the notation of Python's `json`: `NaN`, `Infinity`.

    Attributes:
        path: path of the file.
        items: all objects, in the order of the lines: those that were read and those that were appended since.
    """

    def __init__(self, path: Path):
        """Opens or creates the file, and repairs its end if a writer was killed within a line.

        Raises:
            RuntimeError: if another process writes the file.
            ValueError: if a line other than the last is not a JSON object.
        """
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("a+b")
        try:
            # the kernel releases the lock when its holder ends, in whatever way
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
                # only the line end is missing
                lines.append(tail)
                self._write(b"\n")
        items = []
        for number, line in enumerate(lines, 1):
            try:
                items.append(_parsed(line))
            except ValueError as error:
                raise ValueError(f"{self.path}, line {number} is not a JSON object: {error}") from None
        return items

    def append(self, item: Item) -> None:
        """Appends an object; when the call returns, the object is on the disk.

        Raises:
            TypeError: if a value is not a JSON value.
        """
        self._write(json.dumps(item).encode() + b"\n")
        self.items.append(item)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._file.flush()
        os.fsync(self._file.fileno())

    def __enter__(self) -> Self:
        """Returns the store itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, at: TracebackType | None) -> None:
        """Closes the file, so that another process can write it."""
        self._file.close()


def _parsed(line: bytes) -> Item:
    item = json.loads(line)
    if not isinstance(item, dict):
        raise ValueError(f"{line[:80]!r}")
    return item
