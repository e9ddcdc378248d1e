"""`symjax demo`."""

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


@click.command("demo", context_settings={"show_default": True})
@options.seed(1, "Seed of the object and its scan.")
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", default=Path(), help="Folder to write into.")
@options.force
@options.computing
def command(seed: int, out: Path, force: bool, cache: bool, quiet: bool, debug: bool) -> None:
    """Make a partial, noisy scan of an object and find its mirror plane.

    Writes demo.html and demo.png.
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
    click.echo(_error(detection, scan))
    seconds = perf_counter() - start
    click.echo(f"Written in {seconds:.1f} s in all: {page} (interactive, open it in a browser), {picture}")


def _error(detection: "Detection", scan: "DemoScan") -> str:
    """How far the plane is from the true one."""
    from symjax.geometry.distance import deviation_angle, offset_error

    angle = float(deviation_angle(detection.plane.normal, scan.truth.normal))
    offset = float(offset_error(detection.plane, scan.truth, scan.points.mean(axis=0), detection.diagonal))
    return f"{'error':<10}{angle:.2f} degrees and {offset:.2%} of the diagonal from the true plane"
