"""The published benchmarks, one file a format, and a generated one.

Each `load(folder)` gives a `Shape` at a time, and raises a `DataAbsentError` that says what to get where.
"""

SINGLE = "generated objects with one mirror plane, in random poses"
MADE = "generated objects of all kinds"
WITH_REAL = f"{MADE}, and the real models of `--data` where there are any"
BENCHMARKS = "generated objects, and at full size the real models; or any benchmark by `--benchmark` and `--data`"
PLANTED = "planted pairs: random blobs, their mirror images, and outliers"
"""What studies run on, in words."""
