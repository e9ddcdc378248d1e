"""The interface of a method: the Protocol that `detect` calls, the result that it returns, and the stage timer."""
