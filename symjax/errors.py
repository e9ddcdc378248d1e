"""The error tree: every error that bad input gets is a `SymjaxError`, and so a `ValueError`.

A message says what is wrong, how many, the first index, and what to do.
"""


class SymjaxError(ValueError):
    """Base of every error that symjax raises on purpose."""


class InvalidArgumentError(SymjaxError):
    """An option is out of its range: sigma <= 0, a start that is no direction, too many eigenpairs, ..."""


class InvalidPointsError(SymjaxError):
    """The array is not an (n, 3) array of real numbers."""


class TooFewPointsError(InvalidPointsError):
    """The cloud, or the set of pairs, is too small for what was asked."""


class NonfiniteError(InvalidPointsError):
    """NaN or infinite coordinates."""


class DegenerateCloudError(SymjaxError):
    """The points coincide or lie on one line: no mirror plane is defined by them."""


class SpectrumError(SymjaxError):
    """The Laplacian's eigenpairs could not be computed."""


class MatchingError(SymjaxError):
    """Too few correspondences were found to fit a plane."""


class MethodError(SymjaxError):
    """A method returned what is no result: no candidate, or parts that contradict each other."""


class FileFormatError(SymjaxError):
    """A file is missing, unreadable, truncated, or of a format that is not read."""


class SymjaxWarning(UserWarning):
    """Base of every warning: the answer stands, and something about the input deserves a look."""


class PrecisionWarning(SymjaxWarning):
    """The input's own rounding limits the answer (float32 far from the origin)."""


class DuplicatePointsWarning(SymjaxWarning):
    """Many points coincide; they were merged for the graph."""


class ComponentsWarning(SymjaxWarning):
    """The cloud's neighbourhood graph is in several pieces."""
