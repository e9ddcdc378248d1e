"""The command: `python -m experiments.execution --help`."""

import argparse
import json
from collections import Counter
from pathlib import Path

from experiments.execution.campaign import run


def main() -> None:
    """Runs the tasks of a file and prints how they ended."""
    parser = argparse.ArgumentParser(prog="python -m experiments.execution", description="Many tasks into one file.")
    parser.add_argument("function", metavar="MODULE:FUNCTION")
    parser.add_argument("tasks", type=Path, help="JSON Lines: the keyword arguments of a call in every line")
    parser.add_argument(
        "results", type=Path, help="JSON Lines to append to; what has ended there, but with an error, is not done again"
    )
    parser.add_argument("--jobs", type=int, default=-1, help="tasks at a time; by default one a core")
    parser.add_argument("--dask", default="", metavar="tcp://…", help="scheduler of a cluster to run them on instead")
    parser.add_argument("--seconds", type=float, help="that a task may take")
    parser.add_argument("--megabytes", type=float, help="of memory that a task's process may take")
    given = vars(parser.parse_args())
    function, path, listed = given.pop("function"), given.pop("results"), given.pop("tasks")
    tasks = [json.loads(line) for line in listed.read_text(encoding="utf-8").splitlines()]
    ended = Counter(result.status for result in run(tasks, function, path, **given))
    print(f"{ended.total()} tasks: {', '.join(f'{count} {status}' for status, count in ended.items())} -> {path}")


if __name__ == "__main__":
    main()
