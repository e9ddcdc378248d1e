"""Any folder of meshes or clouds with a listing of their planes (see `listing`)."""

from collections.abc import Iterator
from pathlib import Path

from experiments.data.listing import LISTING, read_listing
from experiments.data.shape import Shape, read_shape
from experiments.framework.absence import required

INSTRUCTIONS = """A folder of meshes or clouds of your own with their planes. Lay it out as
  FOLDER/planes.json  {"NAME": {"file": "FILE", "normal": [x, y, z], "offset": number, "kind": "exact"}, ...}
  FOLDER/FILE         in any format that symjax reads
("normal": null for an object without a plane; "planes": [{"normal": ..., "offset": ...}, ...] for several)"""


def load(folder: Path) -> Iterator[Shape]:
    """The listed objects, in the order of the listing.

    Raises:
        DataAbsentError: there is no listing, or a file that it names is not there.
        FileFormatError: the listing or a file is malformed.
    """
    entries = read_listing(required(folder / LISTING, INSTRUCTIONS))
    paths = {name: required(folder / entry.file, INSTRUCTIONS) for name, entry in entries.items()}
    return (read_shape(paths[name], name, entry.kind, entry.planes) for name, entry in entries.items())
