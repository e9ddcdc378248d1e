"""Runs studies by name: `python -m experiments.run NAME… [--size small|full] [options of the study]`.

    python -m experiments.run list                  the studies and what they show
    python -m experiments.run NAME --help           the options of a study
    python -m experiments.run NAME… [options]       studies; several run one process after the other
    python -m experiments.run all [--size small]    all of them, and then the page of their results
    python -m experiments.run page                  the page, from the results that are there

Results are in `experiments/out`, those of the small size in `experiments/out/small`, unless `--out` says otherwise. The
page stands beside the folder of the results, as `experiments/README.md`, or in it if that is another folder.
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
    """The command; returns its exit status."""
    argv = sys.argv[1:] if argv is None else list(argv)
    names = list(takewhile(lambda argument: not argument.startswith("-"), argv))
    options = argv[len(names) :]
    if not names:
        asked = options and options[0] in ("-h", "--help")
        print(f"{__doc__}\nStudies: {', '.join(STUDIES)}.", file=sys.stdout if asked else sys.stderr)
        return 0 if asked else WRONG_USAGE
    if names == ["list"]:
        return _list()
    if names in (["all"], ["page"]):
        return _with_page(names[0], options)
    for name in names:
        if name not in STUDIES:
            near = get_close_matches(name, STUDIES, n=1)
            advice = f"did you mean {near[0]!r}?" if near else f"choose from {', '.join(STUDIES)}"
            print(f"{name!r} is unknown: {advice}", file=sys.stderr)
            return WRONG_USAGE
    if len(names) == 1:
        return run_study(load(names[0]), options)
    return _status(run_all(names, options))


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
    """All studies, or none, and the page."""
    parser = argparse.ArgumentParser(prog=f"{PROGRAM} {command}")
    add_common(parser)
    given = parser.parse_args(options)
    out = folder_of(given)
    out.mkdir(parents=True, exist_ok=True)
    missing = run_all(list(STUDIES), ["--size", given.size, "--out", str(out)]) if command == "all" else {}
    print(f"-> {write_page(out, missing)}")
    return _status(missing)


def write_page(out: Path, missing: Mapping[str, str]) -> Path:
    """Writes the page of the results in a folder: beside those that are kept, and into any other folder."""
    path = (out.parent if out == RESULTS else out) / "README.md"
    path.write_text(page(out, path.parent, missing), encoding="utf-8")
    return path


def _status(missing: Mapping[str, str]) -> int:
    for name, outcome in missing.items():
        print(f"{name}: {outcome}")
    return int(any(outcome.startswith("failed") for outcome in missing.values()))


if __name__ == "__main__":
    sys.exit(main())
