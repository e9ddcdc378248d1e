"""Which share is right on scans from one side, for ours and for the rivals that the paper compares with on such data.

The paper's numbers are F on twenty real partial scans of other objects; here a scanner at a random viewpoint sees a
generated object, or a real model, from one side. It goes on from the results of `experiments.studies.paper.arena`.
"""

from collections.abc import Sequence

from experiments.comparison import published, sweep
from experiments.comparison.plan import main as command
from experiments.comparison.plan import sizes
from experiments.framework.study import Row

SIZES = sizes("view", "view", methods="robust,sym-hks-printed,sym-hks,nagar-raman,hruda,3dsymm")


def summary(rows: list[Row]) -> list[Row]:
    """A line a benchmark, measure and method, and what the paper prints."""
    return sweep.summary(rows, published.PARTIAL, published.PARTIAL_DATA)


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    command(__file__, __doc__, SIZES, sweep.run, summary, argv=argv)


if __name__ == "__main__":
    main()
