"""Checks every annotation of symjax at every call, in all tests; users pay nothing for it."""

from contextlib import contextmanager

import jaxtyping
import pytest

CHECKER = "beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))"
"""A whole number is a float, too, as for mypy."""

_raises = pytest.raises


def install() -> None:
    """Checks what is imported from now on."""
    jaxtyping.install_import_hook(["symjax"], CHECKER)
    pytest.raises = raises_unchecked


@contextmanager
def raises_unchecked(*args, **options):
    """`pytest.raises`, with the annotations unchecked inside: a wrong argument meets what it meets at a user's."""
    with _raises(*args, **options) as caught:
        jaxtyping.config.update("jaxtyping_disable", True)
        try:
            yield caught
        finally:
            jaxtyping.config.update("jaxtyping_disable", False)
