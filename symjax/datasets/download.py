"""Downloads of the real models over https, by pooch: verified, and kept in the user's cache folder."""

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
"""Required start of an address."""

TIMEOUT = 30
"""Seconds to wait for the server's next data."""


def fetch(name: str, original: Original) -> Path:
    """Returns the path of a model's file; downloads the file if it is absent or has another sha256.

    The file is `models/NAME` with the extension of the original, in $SYMJAX_CACHE or in the folder `symjax` of the
    user's cache folder. It appears there only after the download is complete and verified.

    Args:
        name: name of the model.
        original: address and sha256 of the published file.

    Raises:
        InvalidArgumentError: if pooch is not installed, or the address does not begin with https.
        FileFormatError: if the file cannot be downloaded or stored, or differs from the published one.
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
    # pooch raises OSError if the download fails, and ValueError if the hash differs
    except (OSError, ValueError) as error:
        response = getattr(error, "response", None)
        if response is not None:
            # pooch streams the body, and leaves the connection open when the status is an error
            response.close()
        reason = str(error).rstrip(".")
        raise FileFormatError(
            f"cannot fetch {name!r}: {reason}; try again, or save {original.url} as {cache.abspath / file} yourself"
        ) from error


def require_pooch() -> None:
    """Raises InvalidArgumentError if pooch is not installed."""
    if find_spec("pooch") is None:
        raise InvalidArgumentError(
            'downloading a model needs pooch, which is not installed: run pip install "pooch>=1.8", '
            'or pip install ".[datasets]" in the checkout'
        )


@contextmanager
def _silent(logger: logging.Logger) -> Iterator[None]:
    """Silences the messages about successful downloads that pooch writes to stderr."""
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)
