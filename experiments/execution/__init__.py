"""A runner that can be left alone: many tasks, on one machine or a cluster, into one file that survives a kill.

`run(tasks, "module:function", path)` calls `function(**task)` for every task and appends what comes of it to a file of
JSON Lines. Run again, it does what has not ended yet, or with an error. From the shell, with one JSON object a line as
the tasks:

    python -m experiments.execution module:function tasks.jsonl results.jsonl --jobs 4 --seconds 600 --megabytes 8000
    python -m experiments.execution module:function tasks.jsonl results.jsonl --dask tcp://scheduler:8786

The workers of a cluster must be able to import `experiments` and the function: in the checkout,
`PYTHONPATH=. dask worker tcp://scheduler:8786`. Needs a POSIX system.
"""

from experiments.execution.campaign import run
from experiments.execution.result import Result

__all__ = ["Result", "run"]
