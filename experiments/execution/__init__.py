"""A runner that can be left alone: many tasks, on one machine or a cluster, into one file that survives a kill.

`run(tasks, "module:function", path)` calls `function(**task)` for every task and appends what comes of it to a file of
JSON Lines. Run again, it does what has not ended yet, or with an error. `dask="tcp://scheduler:8786"` is a cluster.

The workers of a cluster must be able to import `experiments` and the function: in the checkout,
`PYTHONPATH=. dask worker tcp://scheduler:8786`. Needs a POSIX system.
"""

from experiments.execution.campaign import run
from experiments.execution.result import Result

__all__ = ["Result", "run"]
