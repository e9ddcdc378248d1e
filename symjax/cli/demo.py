"""The command `symjax demo`."""

from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import click

from symjax.cli import options
from symjax.cli.errors import one_line_errors
from symjax.cli.outputs import check_outputs
from symjax.cli.progress import progress
from symjax.cli.start import start_jax

if TYPE_CHECKING:
    from symjax.datasets.demo_scan import DemoScan
    from symjax.detection.result import Detection


@click.command(
    "demo",
    context_settings={"show_default": True},
    short_help="Find the mirror plane of a generated scan.",
)
@options.seed(1, "Seed of the object and its scan.")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="DIR",
    default=Path(),
    help="Output folder.",
)
@options.force
@options.computing
def command(seed: int, out: Path, force: bool, cache: bool, quiet: bool, debug: bool) -> None:
    """Make a partial, noisy scan of a generated object and find its mirror plane.

    Writes demo.html, an interactive page, and demo.png.
    """
    start = perf_counter()
    page, picture = out / "demo.html", out / "demo.png"
    with one_line_errors(debug), progress(quiet) as (announce, _):
        for path in (page, picture):
            check_outputs({"out": path}, force)
        announce("starting JAX")
        start_jax(cache=cache)
        from symjax.datasets import demo_scan
        from symjax.detection import summary
        from symjax.detection.detect import detect
        from symjax.viz.html import write_html
        from symjax.viz.png import write_png

        announce("making a scan")
        scan = demo_scan.make_scan(seed)
        detection = detect(scan.points, rng=seed, progress=announce)
        announce(f"writing {page}")
        write_html(detection, page, up=scan.up)
        announce(f"writing {picture}")
        write_png(detection, picture, up=scan.up)
    click.echo(f"{demo_scan.DESCRIPTION}; seed {seed}.")
    for line in summary.lines(detection):
        click.echo(line)
    click.echo(_error_line(detection, scan))
    seconds = perf_counter() - start
    click.echo(f"Wrote {page} (interactive: open it in a browser) and {picture}. Total time: {seconds:.1f} s.")


def _error_line(detection: "Detection", scan: "DemoScan") -> str:
    """Returns the line on the errors of the detected plane."""
    from symjax.geometry.distance import deviation_angle, offset_error

    angle = float(deviation_angle(detection.plane.normal, scan.truth.normal))
    offset = float(offset_error(detection.plane, scan.truth, scan.points.mean(axis=0), detection.diagonal))
    return f"{'error':<10}normal {angle:.2f} degrees, offset {offset:.2%} of the diagonal   (from the true plane)"
