"""The command line of a study: the fields of its configuration as options."""

import argparse
import dataclasses
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from experiments.framework.project import results_folder
from experiments.framework.study import Study

PROGRAM = "python -m experiments.run"


class Options(NamedTuple):
    """What a command line asks for.

    Attributes:
        size: "full" or "small".
        folder: of the files.
        config: what is run.
    """

    size: str
    folder: Path
    config: Any


def add_common(parser: argparse.ArgumentParser) -> None:
    """Adds the options that all studies have."""
    parser.add_argument("--size", choices=["full", "small"], default="full", help="by default full")
    help_text = "folder of the files; by default experiments/out, and experiments/out/small for the small size"
    parser.add_argument("--out", type=Path, help=help_text)


def folder_of(given: argparse.Namespace) -> Path:
    """The folder of the files."""
    return (given.out or results_folder(given.size)).resolve()


def parse(study: Study, argv: Sequence[str]) -> Options:
    """Reads the options of a study."""
    parser = argparse.ArgumentParser(prog=f"{PROGRAM} {study.name}", description=study.title)
    add_common(parser)
    default = next(iter(study.sizes.values()))
    names = [f.name for f in dataclasses.fields(default) if isinstance(getattr(default, f.name), (int, float, str))]
    for field in names:
        kind = type(getattr(default, field))
        values = ", ".join(f"{getattr(config, field)} ({size})" for size, config in study.sizes.items())
        parser.add_argument(f"--{field.replace('_', '-')}", type=kind, help=f"by default {values}".replace("%", "%%"))
    given = parser.parse_args(argv)
    changed = {field: getattr(given, field) for field in names if getattr(given, field) is not None}
    config = dataclasses.replace(study.sizes[given.size], **changed)
    folder = folder_of(given)
    return Options(given.size, folder, study.place(config, folder))


def chosen(names: str, known: Iterable[str]) -> list[str]:
    """The names in a comma separated list.

    Raises:
        ValueError: one is not among those known.
    """
    known = list(known)
    listed = [name.strip() for name in names.split(",")]
    for name in listed:
        if name not in known:
            raise ValueError(f"{name!r} is unknown: choose from {', '.join(known)}")
    return listed
