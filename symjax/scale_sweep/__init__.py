"""A survey: the sweep of one file's pairs over σ and starts, with what a person wants to know of it."""
