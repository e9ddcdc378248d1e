"""Objects with known mirror planes, generated or downloaded, and the corruptions that scans have.

```python
sample = symjax.samples.generate("mug", num_points=5000, rng=0)   # in its own frame
posed = symjax.samples.pose(sample, rng=1)                        # planes move along
cloud = symjax.samples.corrupt(posed.points, rng=2, outliers=1.0, missing=0.28)
spot = symjax.samples.load("spot")                                # a real model, from the internet
```
"""

from symjax.samples.corruption import Corrupted, add_noise, add_outliers, corrupt, remove_part
from symjax.samples.kinds import KINDS, Kind, build, generate
from symjax.samples.model import Model, load
from symjax.samples.registry import MODELS, Original
from symjax.samples.sample import Sample, pose
from symjax.samples.scanner import scan
from symjax.samples.solid import Solid

__all__ = [
    "KINDS",
    "MODELS",
    "Corrupted",
    "Kind",
    "Model",
    "Original",
    "Sample",
    "Solid",
    "add_noise",
    "add_outliers",
    "build",
    "corrupt",
    "generate",
    "load",
    "pose",
    "remove_part",
    "scan",
]
