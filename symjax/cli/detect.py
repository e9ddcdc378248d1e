"""The command `symjax detect`."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import click

from symjax.cli import options
from symjax.cli.errors import one_line_errors
from symjax.cli.outputs import Reading, check_outputs, echo_result
from symjax.cli.progress import progress
from symjax.cli.start import start_jax
from symjax.detection import summary
from symjax.detection.methods import METHODS, NAMED

if TYPE_CHECKING:
    from symjax.detection.result import Detection
    from symjax.method.protocol import Method

OWNERS = {"init": "robust", "sigma": "sym-hks", "restarts": "sym-hks"}
"""The method that an option belongs to, for options of one method only."""


@click.command("detect", context_settings={"show_default": True})
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--method",
    type=click.Choice(METHODS),
    default="robust",
    help="Method: robust copes with outliers, missing parts and noise; sym-hks is the paper's Algorithm 1.",
)
@click.option("--remove-ground", is_flag=True, help="Remove the ground plane that the scanned object stands on.")
@click.option(
    "--init",
    type=float,
    nargs=4,
    metavar="NX NY NZ D",
    help="Guess of the plane, NX x + NY y + NZ z = D, tried in addition to all other hypotheses (robust only).",
)
@click.option("--max-planes", type=int, metavar="N", help="Limit on the mirror planes and candidates.  [default: 9]")
@click.option("--keep-outliers", is_flag=True, help="Keep scattered outliers.  [default for sym-hks]")
@click.option("--drop-outliers", is_flag=True, help="Remove scattered outliers.  [default for robust]")
@options.seed(0, "Seed of all random numbers.")
@click.option(
    "--sigma",
    type=float,
    metavar="FRACTION",
    help="Scale of the residual as a fraction of the diagonal (sym-hks only).  [default: 1.4 keypoint spacings]",
)
@click.option("--restarts", type=int, metavar="N", help="Starts of the estimator (sym-hks only).  [default: 64]")
@options.reading
@options.as_json
@options.output("--html", "OUT.html", "Write an interactive HTML page.")
@options.output("--png", "OUT.png", "Write an image.")
@options.output("--mirror", "OUT.ply", "Write the points together with their mirror images.")
@options.output("--save", "OUT.json", "Write the detection as JSON, for symjax.load.")
@options.force
@options.computing
def command(
    file: Path,
    as_json: bool,
    samples: int,
    seed: int,
    nonfinite: Any,
    method: str,
    remove_ground: bool,
    max_planes: int | None,
    keep_outliers: bool,
    drop_outliers: bool,
    force: bool,
    cache: bool,
    quiet: bool,
    debug: bool,
    **chosen: Any,
) -> None:
    """Find the mirror plane of the point cloud or mesh in FILE.

    Reads PLY, OBJ, OFF, STL, GLB, XYZ, TXT, CSV, NPY and PCD. A mesh is sampled uniformly by area.
    """
    outputs = {name: chosen.pop(name) for name in ("html", "png", "mirror", "save")}
    given = {name: value for name, value in chosen.items() if value is not None}
    _check_options(method, given)
    if keep_outliers and drop_outliers:
        raise click.UsageError("--keep-outliers and --drop-outliers contradict each other: use only one of them")
    with one_line_errors(debug), progress(quiet) as (announce, _):
        check_outputs(outputs, force, file, endings={"mirror": (".ply",)})
        announce("reading")
        start = perf_counter()
        from symjax.io.points import read_points

        points, note = read_points(file, num_samples=samples, rng=seed)
        reading = Reading(file, note, perf_counter() - start)
        announce("starting JAX")
        start_jax(cache=cache)
        from symjax.detection.detect import MAX_PLANES, detect

        detection = detect(
            points,
            _method(method, given),
            rng=seed,
            nonfinite=nonfinite,
            drop_outliers=drop_outliers if keep_outliers or drop_outliers else None,
            remove_ground=remove_ground,
            max_planes=MAX_PLANES if max_planes is None else max_planes,
            progress=announce,
        )
        _write(detection, outputs, announce)
    echo_result(reading, detection.to_dict() if as_json else None, summary.lines(detection), outputs)


def _check_options(method: str, given: dict[str, Any]) -> None:
    """Raises UsageError if an option belongs to another method."""
    for name in given:
        if (owner := OWNERS[name]) != method:
            raise click.UsageError(f"--{name} is an option of method {owner}, not of {method}: use --method {owner}")


def _method(name: str, given: dict[str, Any]) -> "Method":
    """Returns the method with its options."""
    if name == "sym-hks":
        from symjax.symhks.method import SymHKS

        return SymHKS(**given)
    if "init" in given:
        import numpy as np

        from symjax.geometry.plane import Plane
        from symjax.robust.method import Robust

        *normal, offset = given["init"]
        return Robust(init=Plane(np.array(normal), np.array(offset)))
    return NAMED[name]()


def _write(detection: "Detection", outputs: dict[str, Path | None], announce: Callable[[str], None]) -> None:
    """Writes every requested output. `check_outputs` has already checked the paths."""
    from symjax.io.points import write_points
    from symjax.viz.html import write_html

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
