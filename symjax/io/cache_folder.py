"""The folder for downloads and compiled programs."""

import os
from pathlib import Path

VARIABLE = "SYMJAX_CACHE"
"""Environment variable that sets the folder."""


def cache_folder() -> Path:
    """Returns $SYMJAX_CACHE, or else `symjax` in the user's cache folder. The folder may not exist."""
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get(VARIABLE) or Path(home) / "symjax").expanduser()
