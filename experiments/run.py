"""Runs studies by name: `python -m experiments.run NAME… [--size small|full] [options of the study]`.

    python -m experiments.run list                  list the studies and what they show
    python -m experiments.run NAME --help           show the options of a study
    python -m experiments.run NAME… [options]       run studies, several one after the other in processes of their own
    python -m experiments.run all [--size small]    run all studies, then write the page of their results
    python -m experiments.run page                  write the page from the results that exist

Results go to `experiments/out`, those of the small size to `experiments/out/small`, unless `--out` names another
folder. The page of the results in `experiments/out` is `experiments/README.md`; the page of any other folder is written
into that folder.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from itertools import takewhile
from pathlib import Path

from experiments.framework.catalogue import STUDIES, load
from experiments.framework.options import PROGRAM, add_common, folder_of
from experiments.framework.page import page
from experiments.framework.project import RESULTS
from experiments.framework.run_all import run_all
from experiments.framework.run_study import run_study

WRONG_USAGE = 2


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command and returns its exit status."""
    argv = sys.argv[1:] if argv is None else list(argv)
    names = list(takewhile(lambda argument: not argument.startswith("-"), argv))
    options = argv[len(names) :]
    if not names:
        wants_help = bool(options) and options[0] in ("-h", "--help")
        print(f"{__doc__}\nStudies: {', '.join(STUDIES)}.", file=sys.stdout if wants_help else sys.stderr)
        return 0 if wants_help else WRONG_USAGE
    if names == ["list"]:
        return _list()
    if names in (["all"], ["page"]):
        return _with_page(names[0], options)
    for name in names:
        if name not in STUDIES:
            near = get_close_matches(name, STUDIES, n=1)
            advice = f"did you mean {near[0]!r}?" if near else f"choose from {', '.join(STUDIES)}"
            print(f"there is no study {name!r}: {advice}", file=sys.stderr)
            return WRONG_USAGE
    if len(names) == 1:
        return run_study(load(names[0]), options)
    return _exit_status(run_all(names, options))


def _list() -> int:
    width = max(map(len, STUDIES))
    for name in STUDIES:
        try:
            title = load(name).title
        except ImportError as error:
            title = f"cannot be run here: {error}"
        print(f"{name.ljust(width)}  {title}")
    return 0


def _with_page(command: str, options: Sequence[str]) -> int:
    """Runs all studies if the command is "all", and writes the page."""
    parser = argparse.ArgumentParser(prog=f"{PROGRAM} {command}")
    add_common(parser)
    arguments = parser.parse_args(options)
    out = folder_of(arguments)
    out.mkdir(parents=True, exist_ok=True)
    missing = run_all(list(STUDIES), ["--size", arguments.size, "--out", str(out)]) if command == "all" else {}
    print(f"-> {write_page(out, missing)}")
    return _exit_status(missing)


def write_page(out: Path, missing: Mapping[str, str]) -> Path:
    """Writes the page of the results in a folder and returns its path.

    The page stands beside the folder of the results that are kept in the repository, and inside any other folder.
    """
    path = (out.parent if out == RESULTS else out) / "README.md"
    path.write_text(page(out, path.parent, missing), encoding="utf-8")
    return path


def _exit_status(missing: Mapping[str, str]) -> int:
    """Prints why studies have no results; returns 1 if one of them failed. Absent data is no failure."""
    for name, outcome in missing.items():
        print(f"{name}: {outcome}")
    return int(any(outcome.startswith("failed") for outcome in missing.values()))


if __name__ == "__main__":
    sys.exit(main())
