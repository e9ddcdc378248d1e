"""What a command writes: its files, checked before the work, and its answer on the terminal."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import click

from symjax.errors import InvalidArgumentError


def check_outputs(
    outputs: Mapping[str, Path | None], force: bool, *inputs: Path, endings: Mapping[str, tuple[str, ...]] | None = None
) -> None:
    """Refuse before the work, not after it.

    Args:
        outputs: the path that each option names.
        force: files that exist may be replaced.
        *inputs: files that are read.
        endings: those that the path of an option may have, where its format depends on it.

    Raises:
        InvalidArgumentError: a path that cannot be written to, or must not be.
    """
    seen = {path.resolve() for path in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        known = (endings or {}).get(option, ())
        why = ""
        if path.resolve() in seen:
            why = "it is the input or another output"
        elif path.is_dir():
            why = "it is a folder"
        elif path.exists() and not force:
            why = "it exists; use --force to replace it"
        elif not path.parent.is_dir():
            why = f"there is no folder {str(path.parent)!r}"
        elif known and path.suffix.lower() not in known:
            why = f"the format follows from the ending; end the name in {' or '.join(known)}"
        if why:
            raise InvalidArgumentError(f"cannot write {str(path)!r} (--{option}): {why}")
        seen.add(path.resolve())


class Reading(NamedTuple):
    """How a file was read, and how long it took."""

    file: Path
    note: str
    seconds: float


def echo_answer(
    reading: Reading, values: Mapping[str, Any] | None, lines: Iterable[str], outputs: Mapping[str, Path | None]
) -> None:
    """Prints the answer on stdout.

    Args:
        reading: of the file that the answer is about.
        values: the answer as JSON; None prints the lines and the files that were written instead.
        lines: the answer for a person.
        outputs: the files, None where an option was not given.
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
