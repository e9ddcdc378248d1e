"""The stages of a detection: each is announced as it begins and timed."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


class StageTimer:
    """Announces stages to `progress` and keeps the seconds that each took, in order.

    Attributes:
        seconds: of every stage that has ended.

    Example:
        >>> timer = StageTimer(print)
        >>> with timer.stage("searching"):
        ...     pass
        searching
        >>> list(timer.seconds)
        ['searching']
    """

    def __init__(self, progress: Callable[[str], None] | None = None) -> None:
        """A timer that has seen no stage.

        Args:
            progress: called with the name of every stage as it begins.
        """
        self.seconds: dict[str, float] = {}
        self._progress = progress

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Times the block under a name."""
        if self._progress is not None:
            self._progress(name)
        start = perf_counter()
        yield
        self.seconds[name] = perf_counter() - start
