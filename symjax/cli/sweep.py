"""The command `symjax sweep`."""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from symjax.cli import options
from symjax.cli.errors import one_line_errors
from symjax.cli.outputs import Reading, check_outputs, echo_result
from symjax.cli.progress import progress
from symjax.cli.sigmas import Sigmas
from symjax.cli.start import start_jax
from symjax.l2e.solvers.names import SOLVER_NAMES
from symjax.l2e.starts.names import STARTS

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Float


@click.command(
    "sweep",
    context_settings={"show_default": True},
    short_help="Fit the plane at many scales and from many starts.",
)
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--pairs",
    "is_pairs",
    is_flag=True,
    help="FILE contains pairs in six columns: x y z of a point, then x y z of its putative mirror image.",
)
@click.option(
    "--sigma",
    "fractions",
    type=Sigmas(),
    metavar="FIRST:LAST:COUNT",
    default="0.005:0.2:24",
    help="Scales of the residual as fractions of the diagonal: a geometric progression, or a comma-separated list.",
)
@click.option("--restarts", type=click.IntRange(min=1), metavar="N", default=256, help="Starts at every scale.")
@click.option(
    "--start",
    type=click.Choice(STARTS),
    default="fibonacci",
    help="Kind of starts; rga, pca and l2 are single starts.",
)
@click.option("--solver", type=click.Choice(SOLVER_NAMES), default="newton", help="Solver that minimises the loss.")
@click.option(
    "--continuation",
    is_flag=True,
    help="Start every scale from the optima of the next larger one: cheaper, but shows no basins.",
)
@options.seed(0, "Seed of random starts and of the points sampled from a mesh.")
@options.reading
@options.as_json
@options.output("--out", "OUT.nc|OUT.csv", "Write every fit, as netCDF (needs xarray) or CSV.")
@options.output("--html", "OUT.html", "Write an interactive HTML page.")
@options.force
@options.computing
def command(
    file: Path,
    is_pairs: bool,
    fractions: tuple[float, ...],
    samples: int,
    nonfinite: Any,
    as_json: bool,
    out: Path | None,
    html: Path | None,
    force: bool,
    cache: bool,
    quiet: bool,
    debug: bool,
    **chosen: Any,
) -> None:
    """Fit the mirror plane of FILE at many scales sigma and from many starts.

    FILE is a point cloud or a mesh, as for `symjax detect`, and its pairs are the correspondences of Sym-HKS. With
    --pairs, FILE contains putative mirror pairs (CSV, TXT, XYZ or NPY).

    Prints a line for every scale: the best plane, its loss, the fraction of the starts that converged, the number of
    distinct optima that they reached, and the fraction of the pairs that are inliers (100 % if sigma is larger than the
    scale of the residuals). The last lines give the plane that is fitted together with sigma.
    """
    outputs = {"out": out, "html": html}
    with one_line_errors(debug), progress(quiet) as (stage, advance):
        check_outputs(outputs, force, file, endings={"out": (".nc", ".csv")})
        stage("reading")
        start = perf_counter()
        read, note = _read(file, is_pairs, samples=samples, seed=chosen["seed"])
        reading = Reading(file, note, perf_counter() - start)
        stage("starting JAX")
        start_jax(cache=cache, all_cores=True)
        from symjax.l2e.xarray_export import require_xarray
        from symjax.scale_sweep import export, summary
        from symjax.scale_sweep.pairs import cloud_pairs, given_pairs
        from symjax.scale_sweep.run import Options, scale_sweep

        if out is not None and out.suffix.lower() == ".nc":
            require_xarray()
        stage("preparing")
        pairs = (given_pairs if is_pairs else cloud_pairs)(*read, nonfinite=nonfinite)
        found = scale_sweep(pairs, fractions, Options(**chosen), stage=stage, advance=advance)
        if out is not None:
            stage(f"writing {out}")
            export.write(found, out)
        if html is not None:
            from symjax.scale_sweep.page import write_html

            stage(f"writing {html}")
            write_html(found, html)
    echo_result(reading, summary.as_dict(found) if as_json else None, summary.lines(found), outputs)


def _read(file: Path, is_pairs: bool, *, samples: int, seed: int) -> tuple[tuple["Float[np.ndarray, 'n 3']", ...], str]:
    """Returns the points, or the two points of every pair, and a sentence on how they were read."""
    if is_pairs:
        from symjax.io.pairs import read_pairs

        x, y, note = read_pairs(file)
        return (x, y), note
    from symjax.io.points import read_points

    points, note = read_points(file, num_samples=samples, rng=seed)
    return (points,), note
