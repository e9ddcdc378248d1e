"""A task: a function by its name, and what it is called with."""

import hashlib
import json
from typing import Any, NamedTuple

Parameters = dict[str, Any]
"""JSON values by the name of the argument."""


class Task(NamedTuple):
    """One call, whose result depends on nothing else.

    Attributes:
        function: `module:function`.
        parameters: its keyword arguments, JSON values.
    """

    function: str
    parameters: Parameters

    @property
    def identity(self) -> str:
        """What tells it from other tasks in every run and process: 16 hexadecimal digits.

        Raises:
            TypeError: a parameter is no JSON value.
            ValueError: a parameter is not finite, and so equals nothing.
        """
        text = json.dumps([self.function, self.parameters], sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def seed(self) -> int:
        """32 bits, from the identity: the same wherever and after whatever the task runs."""
        return int(self.identity[:8], 16)
