"""What a method is, and what it answers: the Protocol that `detect` calls, `MethodResult`, and the stage timer."""
