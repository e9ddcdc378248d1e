"""The registry of real models: every entry is complete, and pinned to one version of its file."""

import json
import re

import numpy as np
import pytest

from symjax.datasets import MODELS
from symjax.io.points import CLOUDS, MESHES


@pytest.mark.parametrize("name", MODELS)
def test_every_entry_is_complete_and_pinned_to_one_commit(name):
    entry = MODELS[name]
    assert re.fullmatch(r"https://raw\.githubusercontent\.com/[\w-]+/[\w-]+/[0-9a-f]{40}/[\w/.-]+", entry.url)
    assert re.fullmatch(r"[0-9a-f]{64}", entry.sha256)
    assert "." + entry.url.rsplit(".", 1)[1] in {*MESHES, *CLOUDS}
    assert entry.num_bytes > 0
    assert entry.licence
    assert entry.attribution
    assert entry.symmetry
    assert (entry.plane is None) == (entry.normal is None) == (entry.offset is None)
    if entry.plane is not None:
        assert np.linalg.norm(entry.plane.normal) == 1


def test_the_registry_equals_the_shared_one(models):
    origins = json.loads((models.parent / "registry.json").read_text(encoding="utf-8"))
    planes = json.loads((models.parent / "planes.json").read_text(encoding="utf-8"))
    assert set(MODELS) == set(origins) == set(planes)
    for name, entry in MODELS.items():
        origin, plane = origins[name], planes[name]
        expected = (*(origin[key] for key in ("url", "sha256", "bytes", "licence", "attribution")), plane["kind"])
        assert (*entry[:5], entry.symmetry) == expected
        assert entry.offset == plane["offset"]
        assert entry.normal == (plane["normal"] and tuple(plane["normal"]))
