"""Ground-truth error and symmetry distance error of the best planes of all methods, on whole objects.

The paper's numbers are of the 1 000 ShapeNet models of PRS-Net; its GTE fits the squared form alone. Here offsets are
about the mean in diagonals, and SDE is of points against a dense sample of the object, in squared diagonals. With
`--benchmark shapenet --data FOLDER` the same runs on those models. It goes on from the results of `experiments.studies.paper.arena`.
"""

from collections.abc import Sequence

from experiments.comparison import published
from experiments.comparison.leaderboard import standings
from experiments.comparison.plan import Config, outcomes, sizes
from experiments.comparison.plan import main as command
from experiments.framework.study import Row

SIZES = sizes("clean", "clean")

COLUMNS = {"GTE squared": "mean squared GTE, 1e-2", "GTE": "mean GTE, 1e-2", "SDE": "mean SDE, 1e-4"}


def run(config: Config) -> list[Row]:
    """A line a benchmark, condition and method."""
    return standings(outcomes(config))


def summary(rows: list[Row]) -> list[Row]:
    """The three errors of every method, and what the paper prints."""
    lines = [
        {"data": row["benchmark"], "condition": row["condition"], "method": row["title"]}
        | {title: row[name] for name, title in COLUMNS.items()}
        | {"answered": f"{row['answered']} of {row['objects']}"}
        for row in rows
    ]
    for method, (gte, sde) in published.GTE_SDE.items():
        about = {"data": published.SHAPENET_DATA, "condition": "clean", "method": f"{method}, printed"}
        lines.append(about | dict(zip(COLUMNS.values(), (gte, "", sde), strict=True)) | {"answered": ""})
    return lines


def main(argv: Sequence[str] | None = None) -> None:
    """The command."""
    command(__file__, __doc__, SIZES, run, summary, argv=argv)


if __name__ == "__main__":
    main()
