"""Objects with known mirror planes, generated or downloaded, and corruptions that make them look like scans.

```python
sample = symjax.datasets.generate("mug", num_points=5000, rng=0)   # in its own frame
posed = symjax.datasets.pose(sample, rng=1)                        # in a random pose; the planes move along
cloud = symjax.datasets.corrupt(posed.points, rng=2, outliers=1.0, missing=0.28)
spot = symjax.datasets.load("spot")                                # a real model, downloaded
```
"""

from symjax.datasets.corruption import Corrupted, add_noise, add_outliers, corrupt, remove_part
from symjax.datasets.kinds import KINDS, Kind, build, generate
from symjax.datasets.models import Model, load
from symjax.datasets.registry import MODELS, Original
from symjax.datasets.sample import Sample, pose
from symjax.datasets.scanner import scan
from symjax.datasets.solids.solid import Solid

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
