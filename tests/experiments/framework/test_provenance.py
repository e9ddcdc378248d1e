"""The provenance of results."""

import dataclasses
import json
from datetime import UTC, datetime

from experiments.framework.project import RESULTS
from experiments.framework.provenance import provenance


def test_paths_are_relative_to_the_checkout():
    @dataclasses.dataclass
    class Config:
        data: str = str(RESULTS)
        methods: str = "a,b"

    about = provenance("command", Config(), "small", datetime.now(UTC), 1.0)
    assert about["config"] == {"data": "experiments/out", "methods": "a,b"}
    for path in RESULTS.glob("*.json"):
        config = json.loads(path.read_text())["config"]
        assert not [value for value in config.values() if isinstance(value, str) and value.startswith("/")]
