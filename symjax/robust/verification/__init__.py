"""Verification: what the cloud says for and against a refined plane.

`scoring` compares the reflected cloud with the cloud at a fine scale, and `contradiction` at a coarse scale. `evidence`
decides which candidate comes first and which others the cloud confirms. `classification` compares their scores with
the `thresholds` and decides what symmetry they make up. `layers` adds the error of sampling layers to the standard
errors. `notes` writes down what was assumed.
"""
