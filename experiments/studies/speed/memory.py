"""Peak memory of a detection, in a process of its own.

`peak_memory` starts the process with a file and a method as arguments. The process prints its peak memory in MiB twice:
after a first detection of few points, and after that of the cloud.
"""

import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

import symjax
from experiments.framework.project import PROJECT
from symjax import datasets

FEW = 5000
"""Points of the first detection, whose memory is that of the program rather than of the cloud."""

LAUNCH = "import subprocess, sys; subprocess.run(sys.argv[1:], check=True)"
"""Program that starts the process: Linux includes the parent's memory in the peak of a child, so it must be small."""

UNIT = 2**20 if sys.platform == "darwin" else 2**10
"""Units of `ru_maxrss` in a MiB."""


class Peak(NamedTuple):
    """Peak resident memory in MiB.

    Attributes:
        first: after the first detection of few points.
        cloud: after the detection of the cloud.
    """

    first: float
    cloud: float


def peak_memory(points: Float[np.ndarray, "n 3"], method: str) -> Peak:
    """Measures the peak memory of the detection of a cloud in a process of its own.

    Raises:
        RuntimeError: if the process fails; the message has its stderr.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cloud.npy"
        np.save(path, points)
        command = [sys.executable, "-m", "experiments.studies.speed.memory", str(path), method]
        launch = [sys.executable, "-c", LAUNCH, *command]
        done = subprocess.run(launch, cwd=PROJECT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"the process that measures memory failed:\n{done.stderr}")
    return Peak(*json.loads(done.stdout))


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / UNIT


def main(path: str, method: str) -> None:
    """Runs the process."""
    symjax.detect(datasets.generate("quadruped", num_points=FEW, rng=0).points, method, rng=0)
    first = _peak()
    symjax.detect(np.load(path), method, rng=0)
    print(json.dumps([first, _peak()]))


if __name__ == "__main__":
    main(*sys.argv[1:])
