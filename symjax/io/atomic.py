"""Writing a file so that a reader never meets half of it."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from symjax.errors import InvalidArgumentError


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary name beside `path`: renamed to it when the block succeeds, removed when it does not.

    Raises:
        InvalidArgumentError: the folder is missing, or the file cannot be written there.
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
