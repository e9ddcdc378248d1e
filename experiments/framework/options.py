"""The command line of a study: every field of its configuration that is a number or a string is an option."""

import argparse
import dataclasses
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from experiments.framework.project import results_folder
from experiments.framework.study import Study

PROGRAM = "python -m experiments.run"


class Options(NamedTuple):
    """The parsed command line of a study.

    Attributes:
        size: "full" or "small".
        folder: folder of the results.
        config: configuration of the study: that of the size, with the options that were passed.
    """

    size: str
    folder: Path
    config: Any


def add_common(parser: argparse.ArgumentParser) -> None:
    """Adds the options that all studies have: `--size` and `--out`."""
    parser.add_argument("--size", choices=["full", "small"], default="full", help="default: full")
    help_text = "folder of the results; default: experiments/out, or experiments/out/small for the small size"
    parser.add_argument("--out", type=Path, help=help_text)


def folder_of(arguments: argparse.Namespace) -> Path:
    """Returns the folder of the results that `--size` and `--out` select."""
    folder: Path = arguments.out or results_folder(arguments.size)
    return folder.resolve()


def parse(study: Study, argv: Sequence[str]) -> Options:
    """Parses the options of a study."""
    parser = argparse.ArgumentParser(prog=f"{PROGRAM} {study.name}", description=study.title)
    add_common(parser)
    default = next(iter(study.sizes.values()))
    names = [f.name for f in dataclasses.fields(default) if isinstance(getattr(default, f.name), (int, float, str))]
    for field in names:
        kind = type(getattr(default, field))
        values = ", ".join(f"{getattr(config, field)} ({size})" for size, config in study.sizes.items())
        parser.add_argument(f"--{field.replace('_', '-')}", type=kind, help=f"default: {values}".replace("%", "%%"))
    arguments = parser.parse_args(argv)
    changed = {field: getattr(arguments, field) for field in names if getattr(arguments, field) is not None}
    config = dataclasses.replace(study.sizes[arguments.size], **changed)
    folder = folder_of(arguments)
    return Options(arguments.size, folder, study.place(config, folder))


def split_names(names: str, known: Iterable[str]) -> list[str]:
    """Splits the comma-separated names of an option, such as `--methods pca,hruda`.

    Args:
        names: the value of the option.
        known: all permitted names.

    Raises:
        ValueError: if a name is not permitted.
    """
    known = list(known)
    listed = [name.strip() for name in names.split(",")]
    for name in listed:
        if name not in known:
            raise ValueError(f"unknown name {name!r}: choose from {', '.join(known)}")
    return listed
