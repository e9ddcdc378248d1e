"""Which share is right as a part of the points is cut away, 0 to 40 %, for all methods.

The part is the points nearest to a random one. The paper's numbers are F on Funk 2017, those here on the data that the
table names. It goes on from the results of `experiments.studies.paper.arena`.
"""

from collections.abc import Sequence
from pathlib import Path

from experiments.comparison import published, sweep
from experiments.comparison.plan import MISSING, Config, sizes
from experiments.comparison.plan import main as command
from experiments.framework.study import Row

SIZES = sizes(MISSING, "clean,miss28")


def summary(rows: list[Row]) -> list[Row]:
    """Methods by conditions, and what the paper prints."""
    return sweep.summary(rows, published.MISSING)


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """F and hit rate against the share of missing points."""
    sweep.draw(rows, path, "missing", published.MISSING)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    command(__file__, __doc__, SIZES, sweep.run, summary, draw=draw, argv=argv)


if __name__ == "__main__":
    main()
