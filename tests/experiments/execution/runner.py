"""Runs the tasks of a file, until a test kills it. Arguments: function, tasks, results, and options as JSON."""

import json
import sys
from pathlib import Path

from experiments.execution import run

if __name__ == "__main__":
    function, tasks, results, options = sys.argv[1:]
    lines = Path(tasks).read_text(encoding="utf-8").splitlines()
    run([json.loads(line) for line in lines], function, Path(results), **json.loads(options))
