"""The persistent compilation cache: what one process compiled, the next one loads."""

from pathlib import Path

import jax

from symjax.io.cache_folder import cache_folder


def enable_compilation_cache(folder: str | Path | None = None) -> Path:
    """Keeps compiled programs in a folder from now on, those that compile in no time among them.

    A first fit compiles for seconds; in a later process it is loaded in a fraction of one. Nothing is kept unless
    this is called: it changes JAX's configuration for the whole process.

    Args:
        folder: where; None is $SYMJAX_CACHE, or `symjax` in the user's cache folder.

    Returns:
        The folder, which is made.
    """
    path = cache_folder() if folder is None else Path(folder).expanduser()
    path.mkdir(parents=True, exist_ok=True)
    jax.config.update("jax_compilation_cache_dir", str(path))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
    return path
