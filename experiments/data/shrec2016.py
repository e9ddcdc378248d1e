"""Loads SHREC'16 "Partial matching of deformable shapes" (Cosmo et al. 2016): animals and people with cuts or holes.

The folders `cuts` and `holes` hold OFF meshes, and `null` holds the whole shapes in rest pose, as described in the
archive's README. The track publishes correspondences but no planes, and a bent body has no mirror plane: the paper
shows its results on eight shapes without a score. If a `planes.json` (`experiments.data.listing`) with annotated planes
lies beside these folders, the loader uses it.
"""

from collections.abc import Iterator
from pathlib import Path

from experiments.data.listing import LISTING, read_listing
from experiments.data.shape import Shape, read_shape
from experiments.framework.absence import DataAbsentError, require

INSTRUCTIONS = """SHREC'16: partial matching of deformable shapes.
Get http://www.dais.unive.it/~shrec2016/data/shrec2016_PartialDeformableShapes.zip (training) or
http://www.dais.unive.it/~shrec2016/data/shrec2016_PartialDeformableShapes_TestSet.zip, and lay it out as
  FOLDER/cuts/cuts_NAME_shape_NUMBER.off
  FOLDER/holes/holes_NAME_shape_NUMBER.off
  FOLDER/null/NAME.off
  FOLDER/planes.json       your own annotations, if any, by the name of the OFF file without its extension"""


def load(folder: Path, part: str = "cuts") -> Iterator[Shape]:
    """Loads the shapes of one part, in the order of their names; a shape without annotation has no planes.

    Args:
        folder: a folder with the layout of `INSTRUCTIONS`.
        part: "cuts", "holes" or "null".

    Raises:
        DataAbsentError: if the folder of the part does not exist or holds no OFF file.
        FileFormatError: if a file is malformed.
    """
    paths = sorted(require(folder / part, INSTRUCTIONS).glob("*.off"))
    if not paths:
        raise DataAbsentError(f"DATA IS ABSENT: no *.off in {folder / part}\n{INSTRUCTIONS}")
    annotated = folder / LISTING
    entries = read_listing(annotated) if annotated.is_file() else {}
    planes = {path: entries[path.stem].planes if path.stem in entries else () for path in paths}
    return (read_shape(path, path.stem, f"SHREC'16 {part}", planes[path]) for path in paths)
