"""The stages of a detection: each is announced as it begins and timed."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


class Stages:
    """Announces stages to `progress` and keeps the seconds that each took, in order."""

    def __init__(self, progress: Callable[[str], None] | None = None) -> None:
        self.seconds: dict[str, float] = {}
        self._progress = progress

    @contextmanager
    def __call__(self, name: str) -> Iterator[None]:
        """Times the block under a name."""
        if self._progress is not None:
            self._progress(name)
        start = perf_counter()
        yield
        self.seconds[name] = perf_counter() - start
