"""Progress on stderr."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, NamedTuple

import click

CHECKING = ("reading", "starting JAX", "preparing")
"""Stages in which input is refused: a plain log begins after them, so that an error stays one line."""

_STAGE = "symjax: {desc} [{elapsed}]"
_COUNT = "symjax: {desc} {n_fmt}/{total_fmt} |{bar}| [{elapsed}, {remaining} left]"


class Progress(NamedTuple):
    """Where a command reports its progress.

    Attributes:
        stage: called with the name of a stage as it begins.
        advance: called with how many of how many steps of the stage are done, 0 of them first.
    """

    stage: Callable[[str], None]
    advance: Callable[[int, int], None]


@contextmanager
def progress(quiet: bool) -> Iterator[Progress]:
    """The stage at work and the time so far or left; where stderr is no terminal, a plain line for each."""
    if quiet:
        yield Progress(lambda stage: None, lambda done, total: None)
    elif sys.stderr.isatty():
        yield from _bar()
    else:
        yield _log()


def _log() -> Progress:
    start = perf_counter()

    def stage(name: str) -> None:
        if name not in CHECKING:
            click.echo(f"symjax: {name} ...", err=True)

    def advance(done: int, total: int) -> None:
        nonlocal start
        if done == 0:
            start = perf_counter()
        elif done < total:
            left = (perf_counter() - start) / done * (total - done)
            click.echo(f"symjax: {done} of {total} done, {left:.0f} s left ...", err=True)

    return Progress(stage, advance)


def _bar() -> Iterator[Progress]:
    import shutil

    from tqdm import tqdm

    # tqdm itself shows nothing where a terminal does not tell its size
    columns, rows = shutil.get_terminal_size()
    layout: dict[str, Any] = {"bar_format": _STAGE, "ncols": columns, "nrows": rows}
    with tqdm(total=0, leave=False, file=sys.stderr, **layout) as bar:

        def stage(name: str) -> None:
            bar.bar_format = _STAGE
            bar.set_description_str(name)

        def advance(done: int, total: int) -> None:
            bar.bar_format = _COUNT
            if done == 0:
                bar.reset(total)
            bar.n = done
            bar.refresh()

        yield Progress(stage, advance)
