"""Originals of the real models over https: checked, and kept in the user's cache folder (pooch, which is an extra)."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path, PurePosixPath
from urllib.parse import urlsplit

from symjax.datasets.registry import Original
from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.io.cache_folder import cache_folder

SCHEME = "https://"
"""How an address must begin."""

TIMEOUT = 30
"""Seconds that the server may be silent."""


def fetch(name: str, original: Original) -> Path:
    """The original's file on this machine, downloaded if it is not there or has another sha256.

    It is kept as `models/NAME` with the original's extension, in $SYMJAX_CACHE or in `symjax` in the user's cache
    folder, and appears there only when it is complete and right.

    Args:
        name: of the model.
        original: its address and sha256.

    Raises:
        InvalidArgumentError: pooch is not installed, or the address is not https.
        FileFormatError: it cannot be downloaded or stored, or is not what was published.
    """
    require_pooch()
    if not original.url.startswith(SCHEME):
        raise InvalidArgumentError(f"{original.url} is not fetched: the address must begin with {SCHEME}")
    import pooch

    file = f"models/{name}{PurePosixPath(urlsplit(original.url).path).suffix}"
    cache = pooch.create(
        path=cache_folder(),
        base_url="",
        registry={file: f"sha256:{original.sha256}"},
        urls={file: original.url},
    )
    try:
        with _silent(pooch.get_logger()):
            return Path(cache.fetch(file, downloader=pooch.HTTPDownloader(timeout=TIMEOUT)))
    # whatever goes wrong on the way is an OSError, a wrong hash a ValueError
    except (OSError, ValueError) as error:
        reason = str(error).rstrip(".")
        raise FileFormatError(
            f"cannot fetch {name!r}: {reason}; try again, or save {original.url} as {cache.abspath / file} yourself"
        ) from error


def require_pooch() -> None:
    """Raises InvalidArgumentError where pooch is not installed."""
    if find_spec("pooch") is None:
        raise InvalidArgumentError(
            'a download needs pooch, which is not installed: pip install "pooch>=1.8", '
            'or symjax with its extra, pip install ".[datasets]" in the checkout'
        )


@contextmanager
def _silent(logger: logging.Logger) -> Iterator[None]:
    """A library does not write to stderr about what went well."""
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)
