"""SHREC'16 "Partial matching of deformable shapes" (Cosmo et al. 2016): animals and people with cuts or holes.

OFF meshes in the folders `cuts` and `holes`, and the whole shapes in rest pose in `null`, as the archive's README has
it. The track publishes correspondences and no planes, and a body that is bent has none: the paper shows what it finds
on eight shapes and scores nothing. Planes that someone annotates are read from a `planes.json` of the form of
`listing`, beside these folders.
"""

from collections.abc import Iterator
from pathlib import Path

from experiments.data.listing import LISTING, read_listing
from experiments.data.shape import Shape, read_shape
from experiments.framework.absence import DataAbsentError, required

INSTRUCTIONS = """SHREC'16: partial matching of deformable shapes.
Get http://www.dais.unive.it/~shrec2016/data/shrec2016_PartialDeformableShapes.zip (training) or
http://www.dais.unive.it/~shrec2016/data/shrec2016_PartialDeformableShapes_TestSet.zip, and lay it out as
  FOLDER/cuts/cuts_NAME_shape_NUMBER.off
  FOLDER/holes/holes_NAME_shape_NUMBER.off
  FOLDER/null/NAME.off
  FOLDER/planes.json       planes annotated by you, if any; a name is that of the OFF file without its extension"""


def load(folder: Path, part: str = "cuts") -> Iterator[Shape]:
    """The shapes of one part, by name; with planes only where they are annotated.

    Args:
        folder: laid out as `INSTRUCTIONS` say.
        part: "cuts", "holes" or "null".

    Raises:
        DataAbsentError: there is no such folder, or no OFF file in it.
        FileFormatError: a file is malformed.
    """
    paths = sorted(required(folder / part, INSTRUCTIONS).glob("*.off"))
    if not paths:
        raise DataAbsentError(f"DATA IS ABSENT: no *.off in {folder / part}\n{INSTRUCTIONS}")
    annotated = folder / LISTING
    entries = read_listing(annotated) if annotated.is_file() else {}
    planes = {path: entries[path.stem].planes if path.stem in entries else () for path in paths}
    return (read_shape(path, path.stem, f"SHREC'16 {part}", planes[path]) for path in paths)
