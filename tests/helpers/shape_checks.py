"""Run-time checks of all type and shape annotations of symjax, switched on in the tests only."""

from contextlib import contextmanager

import jaxtyping
import pytest

CHECKER = "beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))"
"""Accepts an int for a float, as mypy does."""

_raises = pytest.raises


def install() -> None:
    """Switches the checks on for all modules of symjax that are imported afterwards."""
    jaxtyping.install_import_hook(["symjax"], CHECKER)
    pytest.raises = raises_unchecked


@contextmanager
def raises_unchecked(*args, **options):
    """Runs `pytest.raises` without the checks, so that a wrong argument raises the error that users see."""
    with _raises(*args, **options) as caught:
        jaxtyping.config.update("jaxtyping_disable", True)
        try:
            yield caught
        finally:
            jaxtyping.config.update("jaxtyping_disable", False)
