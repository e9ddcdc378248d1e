"""How the command line starts JAX."""

import os
from typing import Any


def start_jax(*, cache: bool, all_cores: bool = False) -> None:
    """Imports JAX, and settles what has to be settled before it computes.

    Args:
        cache: keep compiled programs in the user's cache folder.
        all_cores: show JAX every core as a device, for batches that are dealt out to all devices.

    Raises:
        InvalidArgumentError: the cache folder cannot be made.
    """
    from symjax.errors import InvalidArgumentError
    from symjax.l2e.jax_config import enable_compilation_cache

    if all_cores:
        _use_all_cores()
    if cache:
        try:
            enable_compilation_cache()
        except OSError as error:
            raise InvalidArgumentError(f"cannot keep compiled programs (--cache): {error}") from error


def _use_all_cores() -> None:
    import jax

    config: Any = jax.config
    # -1 is JAX's own default; before there was an option, the flag was the way to set it
    if config.jax_num_cpu_devices != -1 or "host_platform_device_count" in os.environ.get("XLA_FLAGS", ""):
        return
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        config.update("jax_num_cpu_devices", cores)
    except RuntimeError:
        # JAX computes already: the command was called from within a program, whose devices these are
        return
