"""Methods of other people, to compare with: one module each, faithful to its publication.

`experiments.baselines.baseline` says how to add one.
"""
