"""The folder in which symjax keeps what it downloads and compiles."""

import os
from pathlib import Path

VARIABLE = "SYMJAX_CACHE"
"""Environment variable that names the folder."""


def cache_folder() -> Path:
    """$SYMJAX_CACHE, or `symjax` in the user's cache folder; it is not made."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get(VARIABLE) or Path(home) / "symjax").expanduser()
