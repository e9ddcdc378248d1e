"""Starting JAX from the command line."""

import os
from typing import Any


def start_jax(*, cache: bool, all_cores: bool = False) -> None:
    """Imports JAX and configures it.

    Args:
        cache: whether to keep compiled programs in the user's cache folder.
        all_cores: whether every CPU core becomes a device of JAX, for batches that are split among the devices.

    Raises:
        InvalidArgumentError: if the cache folder cannot be created.
    """
    from symjax.errors import InvalidArgumentError
    from symjax.l2e.jax_config import enable_compilation_cache

    if all_cores:
        _use_all_cores()
    if cache:
        try:
            enable_compilation_cache()
        except InvalidArgumentError as error:
            raise InvalidArgumentError(f"cannot cache compiled programs (--cache): {error.__cause__}") from error


def _use_all_cores() -> None:
    import jax

    config: Any = jax.config
    # -1 is JAX's default; older programs set the number by the flag
    if config.jax_num_cpu_devices != -1 or "host_platform_device_count" in os.environ.get("XLA_FLAGS", ""):
        return
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        config.update("jax_num_cpu_devices", cores)
    except RuntimeError:
        # JAX is already running in the program that called this command: its devices are kept
        return
