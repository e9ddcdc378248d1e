"""`symjax sweep`."""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from symjax.cli import options
from symjax.cli.errors import one_line_errors
from symjax.cli.outputs import Reading, check_outputs, echo_answer
from symjax.cli.progress import progress
from symjax.cli.sigmas import Sigmas
from symjax.cli.start import start_jax
from symjax.l2e.solvers.names import SOLVER_NAMES
from symjax.l2e.starts.names import STARTS

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import Float


@click.command("sweep", context_settings={"show_default": True})
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--pairs", "is_pairs", is_flag=True, help="FILE holds pairs, six columns: x y z and those of the partner."
)
@click.option(
    "--sigma",
    "fractions",
    type=Sigmas(),
    metavar="FIRST:LAST:COUNT",
    default="0.005:0.2:24",
    help="Scales of the residual in equal ratios, fractions of the diagonal; or a list separated by commas.",
)
@click.option("--restarts", type=click.IntRange(min=1), metavar="N", default=256, help="Starts at every scale.")
@click.option("--start", type=click.Choice(STARTS), default="fibonacci", help="What they are; the last three are one.")
@click.option("--solver", type=click.Choice(SOLVER_NAMES), default="newton", help="How a fit is found.")
@click.option(
    "--continuation", is_flag=True, help="Go from the largest scale to the smallest: cheaper, shows no basins."
)
@options.seed(0, "Seed of random starts, and of the sampling of a mesh.")
@options.reading
@options.as_json
@options.output("--out", "OUT.nc|OUT.csv", "Write every fit (netCDF needs xarray).")
@options.output("--html", "OUT.html", "Write an interactive page.")
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
    """Fit the mirror plane of FILE at many scales sigma, from many starts.

    FILE is a scan or a mesh, as for `symjax detect`, whose pairs are the correspondences of Sym-HKS; or, with --pairs,
    putative mirror pairs (CSV, TXT, XYZ or NPY). A line is printed for every scale: the best plane, its loss, the share
    of starts that converged, the number of distinct optima that they reached, and the share of mirror pairs (100 %
    where the scale is larger than the residual's own). The last lines are the plane with its scale estimated.
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
    echo_answer(reading, summary.as_dict(found) if as_json else None, summary.lines(found), outputs)


def _read(file: Path, is_pairs: bool, *, samples: int, seed: int) -> tuple[tuple["Float[np.ndarray, 'n 3']", ...], str]:
    """The points, or the two ends of the pairs; and how they were read."""
    if is_pairs:
        from symjax.io.pairs import read_pairs

        x, y, note = read_pairs(file)
        return (x, y), note
    from symjax.io.points import read_points

    points, note = read_points(file, num_samples=samples, rng=seed)
    return (points,), note
