"""Which share is right as outliers are added, 0 to 120 % of the points, for all methods.

Outliers are uniform in the bounding box of the posed cloud; how the paper distributes them is not printed. Its numbers
are F on Funk 2017, those here on the data that the table names. It goes on from the results of `experiments.studies.paper.arena`.
"""

from collections.abc import Sequence
from pathlib import Path

from experiments.comparison import published, sweep
from experiments.comparison.plan import OUTLIERS, Config, sizes
from experiments.comparison.plan import main as command
from experiments.framework.study import Row

SIZES = sizes(OUTLIERS, "clean,out100")


def summary(rows: list[Row]) -> list[Row]:
    """Methods by conditions, and what the paper prints."""
    return sweep.summary(rows, published.OUTLIERS)


def draw(config: Config, rows: list[Row], path: Path) -> None:
    """F and hit rate against the share of outliers."""
    sweep.draw(rows, path, "outliers", published.OUTLIERS)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    command(__file__, __doc__, SIZES, sweep.run, summary, draw=draw, argv=argv)


if __name__ == "__main__":
    main()
