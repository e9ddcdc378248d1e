"""Progress of a command, on stderr."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import Any, NamedTuple

import click

CHECKING = ("reading", "starting JAX", "preparing")
"""Stages that check the input. A plain log omits them, so that an error about the input is the only line."""

_STAGE = "symjax: {desc} [{elapsed}]"
_COUNT = "symjax: {desc} {n_fmt}/{total_fmt} |{bar}| [{elapsed}, {remaining} left]"


class Progress(NamedTuple):
    """Functions by which a command reports its progress.

    Attributes:
        stage: takes the name of a stage as it begins.
        advance: takes the number of steps done in the stage, first 0, and the number of all its steps.
    """

    stage: Callable[[str], None]
    advance: Callable[[int, int], None]


@contextmanager
def progress(quiet: bool) -> Iterator[Progress]:
    """Shows the current stage and the time elapsed or left on a terminal, and otherwise prints a line per stage.

    Args:
        quiet: show nothing.
    """
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

    # tqdm alone would show nothing on a terminal of unknown size
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
