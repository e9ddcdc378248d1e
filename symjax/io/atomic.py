"""Atomic writing of files: a reader never sees an incomplete file."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from symjax.errors import InvalidArgumentError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Yields a temporary path beside `path`, and renames it to `path` if the `with` block succeeds.

    If the block fails, the temporary file is removed.

    Raises:
        InvalidArgumentError: if the folder is missing or the file cannot be written.
    """
    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.part")
    try:
        yield temporary
        temporary.replace(target)
    except OSError as error:
        reason = error.strerror or str(error)
        raise InvalidArgumentError(f"cannot write {target}: {reason}; choose another path") from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)
