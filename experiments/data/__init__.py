"""Clouds with known mirror planes: loaders of published benchmarks, one module each, and generated objects.

A loader is a function `load(folder)` that returns an iterator of `Shape`s (`experiments.data.shape`), in a fixed order:

- It checks when it is called that the files exist, and raises a `DataAbsentError` otherwise, whose instructions say
  where to get the data and how to lay it out (`experiments.framework.absence.require`).
- It raises a `FileFormatError` that names the file and the line if a file is malformed (`NumberFile` does).
- It reads the models one at a time, as the iterator advances (`read_shape`).

`experiments.data.shrec2023` is the shortest complete example. A new loader becomes a value of `--benchmark` by one more
entry in `LOADERS` of `experiments.comparison.objects`. Data of your own needs no loader, only a listing: see
`experiments.data.listing`.
"""

GENERATED_SINGLE = "generated objects with one mirror plane, in random poses"
GENERATED = "generated objects of all kinds"
GENERATED_AND_REAL = f"{GENERATED}, and the real models of `--data` if there are any"
BENCHMARKS = "generated objects, and at full size the real models; or any benchmark by `--benchmark` and `--data`"
PLANTED = "planted pairs: random blobs, their mirror images, and outliers"
"""Phrases for `Study.data`: what a study runs on."""
