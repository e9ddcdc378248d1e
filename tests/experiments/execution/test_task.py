"""The identity of a task depends on its values alone."""

import numpy as np
import pytest

from experiments.execution.task import Task


def test_the_identity_of_a_task_depends_on_its_values_alone():
    task = Task("m:f", {"a": 1, "b": [0.1, "x"]})
    assert task.identity == Task("m:f", {"b": [0.1, "x"], "a": 1}).identity
    others = [Task("m:g", task.parameters), Task("m:f", {"a": 2, "b": [0.1, "x"]}), Task("m:f", {"a": 1})]
    assert len({task.identity, *(other.identity for other in others)}) == 4
    # the same as in files of results from last year
    assert Task("m:f", {"a": 1}).identity == "ab8b79db396dba24"
    with pytest.raises(ValueError, match="not JSON compliant"):
        _ = Task("m:f", {"a": np.nan}).identity
