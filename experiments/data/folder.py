"""Loads any folder of meshes or clouds that has a listing of their planes (`experiments.data.listing`)."""

from collections.abc import Iterator
from pathlib import Path

from experiments.data.listing import LISTING, read_listing
from experiments.data.shape import Shape, read_shape
from experiments.framework.absence import require

INSTRUCTIONS = """A folder of your own meshes or clouds, with their planes. Lay it out as
  FOLDER/planes.json  {"NAME": {"file": "FILE", "normal": [x, y, z], "offset": number, "kind": "exact"}, ...}
  FOLDER/FILE         in any format that symjax reads
("normal": null for an object without a mirror plane; "planes": [{"normal": ..., "offset": ...}, ...] for several)"""


def load(folder: Path) -> Iterator[Shape]:
    """Loads the listed objects, in the order of the listing.

    Raises:
        DataAbsentError: if the listing, or a file that it names, does not exist.
        FileFormatError: if the listing or a file is malformed.
    """
    entries = read_listing(require(folder / LISTING, INSTRUCTIONS))
    paths = {name: require(folder / entry.file, INSTRUCTIONS) for name, entry in entries.items()}
    return (read_shape(paths[name], name, entry.kind, entry.planes) for name, entry in entries.items())
