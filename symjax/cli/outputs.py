"""Outputs of a command: checks of its output paths, and its result on the terminal."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import click

from symjax.errors import InvalidArgumentError


def check_outputs(
    outputs: Mapping[str, Path | None], force: bool, *inputs: Path, endings: Mapping[str, tuple[str, ...]] | None = None
) -> None:
    """Checks the output paths before anything is computed.

    Args:
        outputs: the path of each option, or None.
        force: whether existing files may be overwritten.
        *inputs: files that are read.
        endings: the file name extensions that an option accepts, if it accepts only some.

    Raises:
        InvalidArgumentError: if a file cannot be written there, or must not be.
    """
    seen = {path.resolve() for path in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        accepted = (endings or {}).get(option, ())
        why = ""
        if path.resolve() in seen:
            why = "it is also the input or another output"
        elif path.is_dir():
            why = "it is a folder"
        elif path.exists() and not force:
            why = "the file exists; use --force to overwrite it"
        elif not path.parent.is_dir():
            why = f"the folder {str(path.parent)!r} does not exist"
        elif accepted and path.suffix.lower() not in accepted:
            why = f"the file name must end in {' or '.join(accepted)}"
        if why:
            raise InvalidArgumentError(f"cannot write {str(path)!r} (--{option}): {why}")
        seen.add(path.resolve())


class Reading(NamedTuple):
    """How the input file was read.

    Attributes:
        file: the file.
        note: what it contains, as a sentence.
        seconds: time that reading took.
    """

    file: Path
    note: str
    seconds: float


def echo_result(
    reading: Reading, values: Mapping[str, Any] | None, lines: Iterable[str], outputs: Mapping[str, Path | None]
) -> None:
    """Prints the result on stdout.

    Args:
        reading: how the input file was read.
        values: the result as JSON values; None prints the lines and the output files instead.
        lines: the result as text.
        outputs: the output path of each option, or None.
    """
    if values is not None:
        head = {"file": str(reading.file), "reading": {"note": reading.note, "seconds": reading.seconds}}
        click.echo(json.dumps({**head, **values}, allow_nan=False))
        return
    click.echo(f"{'file':<10}{reading.file}   ({reading.note}; read in {reading.seconds:.2f} s)")
    for line in lines:
        click.echo(line)
    for path in outputs.values():
        if path is not None:
            click.echo(f"{'written':<10}{path}")
