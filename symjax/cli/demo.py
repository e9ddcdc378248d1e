"""`symjax demo`."""

from pathlib import Path

import click

from symjax.cli import options
from symjax.cli.errors import one_line_errors
from symjax.cli.outputs import check_outputs
from symjax.cli.progress import progress
from symjax.cli.start import start_jax


@click.command("demo", context_settings={"show_default": True})
@options.seed(1, "Seed of the object and its scan.")
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", default=Path(), help="Folder to write into.")
@options.force
@options.computing
def command(seed: int, out: Path, force: bool, cache: bool, quiet: bool, debug: bool) -> None:
    """Make a partial, noisy scan of an object and find its mirror plane.

    Writes demo.html and demo.png.
    """
    with one_line_errors(debug), progress(quiet) as (announce, _):
        check_outputs({"out": out / "demo.html"}, force)
        check_outputs({"out": out / "demo.png"}, force)
        announce("starting JAX")
        start_jax(cache=cache)
        from symjax.cli import demonstration as demonstration

        lines = demonstration.run(out, seed=seed, progress=announce)
    click.echo("\n".join(lines))
