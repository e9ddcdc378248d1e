"""An unattended runner: it runs many tasks, on one machine or a cluster, and can be killed and resumed at any time.

`run(tasks, "module:function", path)` calls `function(**task)` for every task and appends every result to a file of JSON
Lines. When it is called again, it runs only the tasks that have no result yet or that failed with an error. With
`dask="tcp://scheduler:8786"` the tasks run on a cluster.

The workers of a cluster must be able to import `experiments` and the function: start them in the checkout by
`PYTHONPATH=. dask worker tcp://scheduler:8786`. The runner needs a POSIX system.
"""

from experiments.execution.campaign import run
from experiments.execution.result import Result

__all__ = ["Result", "run"]
