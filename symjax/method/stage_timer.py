"""A timer of the stages of a detection."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


class StageTimer:
    """Announces each stage as it begins, and measures how long it takes.

    Attributes:
        seconds: duration of each finished stage, in order.

    Example:
        >>> timer = StageTimer(print)
        >>> with timer.stage("searching"):
        ...     pass
        searching
        >>> list(timer.seconds)
        ['searching']
    """

    def __init__(self, progress: Callable[[str], None] | None = None) -> None:
        """Creates a timer.

        Args:
            progress: function that is called with the name of each stage as it begins.
        """
        self.seconds: dict[str, float] = {}
        self._progress = progress

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Announces a stage, and times the `with` block.

        Args:
            name: name of the stage, the key of its duration in `seconds`.
        """
        if self._progress is not None:
            self._progress(name)
        start = perf_counter()
        yield
        self.seconds[name] = perf_counter() - start
