"""The published benchmarks, one file a format, and a generated one.

Each `load(folder)` gives a `Shape` at a time, and raises a `DataAbsentError` that says what to get where.
"""
