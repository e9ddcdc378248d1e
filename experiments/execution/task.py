"""A task: the name of a function, and the arguments of one call."""

import hashlib
import json
from typing import Any, NamedTuple

Parameters = dict[str, Any]
"""JSON values, by the name of the argument."""


class Task(NamedTuple):
    """One call of a function; its result must depend on nothing but these fields.

    Attributes:
        function: name of the function, `module:function`.
        parameters: keyword arguments of the call.
    """

    function: str
    parameters: Parameters

    @property
    def identity(self) -> str:
        """Hash of the function's name and the parameters, 16 hexadecimal digits, the same in every run and process.

        Raises:
            TypeError: if a parameter is not a JSON value.
            ValueError: if a parameter is NaN or infinite.
        """
        text = json.dumps([self.function, self.parameters], sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    @property
    def seed(self) -> int:
        """A 32-bit seed from the identity: it depends neither on the process nor on the tasks before."""
        return int(self.identity[:8], 16)
