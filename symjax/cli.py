"""The command line. It imports nothing slow until a file has been read: help and file errors answer at once."""

import json
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from symjax import __version__, report
from symjax.errors import InvalidArgumentError, SymjaxError, SymjaxWarning

if TYPE_CHECKING:
    from symjax.detection import Detection

BAD_INPUT = 2
"""Exit status for bad files, points and options alike."""

CHECKING = ("reading", "starting JAX", "preparing")
"""Stages in which input is refused: a plain log begins after them, so that an error stays one line."""


def main(arguments: Sequence[str] | None = None) -> None:
    """The command `symjax`: errors are one line on stderr and exit status 2."""
    try:
        sys.exit(commands.main(arguments, prog_name="symjax", standalone_mode=False))
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        sys.exit(0)
    except click.UsageError as error:
        help_command = f"{error.ctx.command_path} --help" if error.ctx else "symjax --help"
        _fail(f"{error.format_message()} (see {help_command})")
    except click.ClickException as error:
        _fail(error.format_message())
    except click.Abort:
        click.echo("symjax: interrupted", err=True)
        sys.exit(130)


def _fail(message: str) -> None:
    click.echo(f"symjax: error: {' '.join(message.split())}", err=True)
    sys.exit(BAD_INPUT)


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="symjax")
def commands() -> None:
    """Find the mirror plane of a 3D point cloud."""


def _options(command: Callable[..., None]) -> Callable[..., None]:
    """Options that every command that computes has."""
    for option in (
        click.option("--debug", is_flag=True, help="Show the traceback of an error."),
        click.option("--quiet", is_flag=True, help="No progress on stderr."),
    ):
        command = option(command)
    return command


@commands.command(context_settings={"show_default": True})
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--method", type=click.Choice(["robust", "sym-hks"]), default="robust", help="How the plane is found.")
@click.option("--remove-floor", is_flag=True, help="Leave out the plane that the scan stands on.")
@click.option("--init", type=float, nargs=4, metavar="NX NY NZ D", help="A plane NX x + NY y + NZ z = D to begin with.")
@click.option("--max-planes", type=int, metavar="N", help="Most candidates.  [default: 9]")
@click.option("--keep-outliers", is_flag=True, help="Do not look for scattered outliers (robust).")
@click.option("--drop-outliers", is_flag=True, help="Leave out scattered outliers (sym-hks).")
@click.option("--seed", type=click.IntRange(min=0), metavar="N", default=0, help="Seed of everything random.")
@click.option(
    "--sigma",
    type=float,
    metavar="FRACTION",
    help="Scale of the residual, a fraction of the diagonal (sym-hks).  [default: 1.4 keypoint spacings]",
)
@click.option("--restarts", type=int, metavar="N", help="Starts of the estimator (sym-hks).  [default: 64]")
@click.option("--samples", type=int, metavar="N", default=20_000, help="Points to sample from a mesh.")
@click.option("--nonfinite", type=click.Choice(["raise", "drop"]), default="raise", help="NaN and infinite points.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object instead of text.")
@click.option("--html", type=click.Path(path_type=Path), metavar="OUT.html", help="Write an interactive page.")
@click.option("--png", type=click.Path(path_type=Path), metavar="OUT.png", help="Write a picture.")
@click.option("--mirror", type=click.Path(path_type=Path), metavar="OUT.ply", help="Write the completed object.")
@click.option("--save", type=click.Path(path_type=Path), metavar="OUT.json", help="Write the detection.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@_options
def detect(
    file: Path, as_json: bool, samples: int, seed: int, force: bool, quiet: bool, debug: bool, **options: Any
) -> None:
    """Find the mirror plane of the points or the mesh in FILE.

    Reads PLY, OBJ, OFF, STL, GLB, XYZ, TXT, CSV, NPY and PCD. A mesh is sampled by area.
    """
    outputs = {name: options.pop(name) for name in ("html", "png", "mirror", "save")}
    with _one_line_errors(debug), _progress(quiet) as announce:
        _check_outputs(outputs, force, file)
        announce("reading")
        start = perf_counter()
        from symjax.files.pointfile import read_points

        points, note = read_points(file, num_samples=samples, rng=seed)
        reading = perf_counter() - start
        announce("starting JAX")
        from symjax import pipeline

        if options.pop("keep_outliers"):
            options["drop_outliers"] = False
        elif not options["drop_outliers"]:
            options["drop_outliers"] = None
        if options["init"] is not None:
            options["init"] = (options["init"][:3], options["init"][3])
        given = {name: value for name, value in options.items() if value is not None}
        detection = pipeline.detect(points, rng=seed, progress=announce, **given)
        _write(detection, outputs, announce)
    if as_json:
        head = {"file": str(file), "reading": {"note": note, "seconds": reading}}
        click.echo(json.dumps({**head, **detection.to_dict()}))
        return
    click.echo(f"{'file':<10}{file}   ({note}; read in {reading:.2f} s)")
    for line in report.lines(detection):
        click.echo(line)
    for path in outputs.values():
        if path is not None:
            click.echo(f"{'written':<10}{path}")


@commands.command(context_settings={"show_default": True})
@click.option("--seed", type=click.IntRange(min=0), metavar="N", default=1, help="Seed of the object and its scan.")
@click.option("--out", type=click.Path(path_type=Path), metavar="DIR", default=Path(), help="Folder to write into.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@_options
def demo(seed: int, out: Path, force: bool, quiet: bool, debug: bool) -> None:
    """Make a partial, noisy scan of an object and find its mirror plane.

    Writes demo.html and demo.png.
    """
    with _one_line_errors(debug), _progress(quiet) as announce:
        _check_outputs({"out": out / "demo.html"}, force)
        _check_outputs({"out": out / "demo.png"}, force)
        announce("starting JAX")
        from symjax import demo as demonstration

        lines = demonstration.run(out, seed=seed, progress=announce)
    click.echo("\n".join(lines))


def _check_outputs(outputs: dict[str, Path | None], force: bool, *inputs: Path) -> None:
    """Refuse before the work, not after it."""
    seen = {path.resolve() for path in inputs}
    for option, path in outputs.items():
        if path is None:
            continue
        why = ""
        if path.resolve() in seen:
            why = "it is the input or another output"
        elif path.is_dir():
            why = "it is a folder"
        elif path.exists() and not force:
            why = "it exists; use --force to replace it"
        elif not path.parent.is_dir():
            why = f"there is no folder {str(path.parent)!r}"
        elif option == "mirror" and path.suffix.lower() != ".ply":
            why = "points are written as PLY; end the name in .ply"
        if why:
            raise InvalidArgumentError(f"cannot write {str(path)!r} (--{option}): {why}")
        seen.add(path.resolve())


def _write(detection: "Detection", outputs: dict[str, Path | None], announce: Callable[[str], None]) -> None:
    """Every output that was asked for; existing files were dealt with by `_check_outputs`."""
    from symjax.files.pointfile import write_points
    from symjax.pictures.plot import write_html

    writers: dict[str, Callable[[Path], object]] = {
        "html": lambda path: write_html(detection, path),
        "png": detection.picture,
        "mirror": lambda path: write_points(path, detection.complete(), force=True),
        "save": detection.save,
    }
    for name, path in outputs.items():
        if path is not None:
            announce(f"writing {path}")
            writers[name](path)


@contextmanager
def _one_line_errors(debug: bool) -> Iterator[None]:
    """Our errors become one line (a traceback with `debug`), our warnings one line each."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", SymjaxWarning)
        try:
            yield
        except SymjaxError as error:
            if debug:
                raise
            raise click.ClickException(str(error)) from error
        finally:
            # not while the work goes on: the line of progress would run into them
            for warning in caught:
                click.echo(f"symjax: warning: {' '.join(str(warning.message).split())}", err=True)


@contextmanager
def _progress(quiet: bool) -> Iterator[Callable[[str], None]]:
    """On stderr, the stage at work and the time so far; where stderr is no terminal, a plain line a stage."""
    if quiet:
        yield lambda stage: None
        return
    if not sys.stderr.isatty():
        yield lambda stage: None if stage in CHECKING else click.echo(f"symjax: {stage} ...", err=True)
        return
    import shutil

    from tqdm import tqdm

    # tqdm itself shows nothing where a terminal does not tell its size
    columns, rows = shutil.get_terminal_size()
    layout = {"bar_format": "symjax: {desc} [{elapsed}]", "ncols": columns, "nrows": rows}
    with tqdm(total=0, leave=False, file=sys.stderr, **layout) as bar:
        yield bar.set_description_str


if __name__ == "__main__":
    main()
