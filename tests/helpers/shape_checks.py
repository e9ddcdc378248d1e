"""Every annotation of symjax checked at every call: `pytest --check-shapes`."""

import traceback
from contextlib import contextmanager
from pathlib import Path

import pytest
from jaxtyping import TypeCheckError, install_import_hook

CHECKER = "beartype.beartype(conf=beartype.BeartypeConf(is_pep484_tower=True))"
"""A whole number is a float, too, as for mypy."""

PACKAGE = Path(__file__).resolve().parents[2] / "symjax"

_raises = pytest.raises


def install() -> None:
    """Checks what is imported from now on."""
    install_import_hook(["symjax"], CHECKER)
    pytest.raises = raises_or_skip


@contextmanager
def raises_or_skip(*args, **options):
    """`pytest.raises`, but skips a test whose wrong argument is refused by the annotation before symjax can refuse it.

    Only where the test itself passes the argument: what symjax passes to itself is never wrong on purpose.
    """
    with _raises(*args, **options) as caught:
        try:
            yield caught
        except TypeCheckError as error:
            if any(Path(frame.filename).is_relative_to(PACKAGE) for frame in traceback.extract_tb(error.__traceback__)):
                raise
            pytest.skip("the annotation forbids this argument")
