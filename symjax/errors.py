"""Errors and warnings. Bad input always raises a `SymjaxError`, which is a `ValueError`.

A message says what is wrong, where (the first index or line), the offending value, and what to do instead.
"""


class SymjaxError(ValueError):
    """Base class of all errors that symjax raises for bad input.

    Example:
        >>> import symjax
        >>> try:
        ...     symjax.read_points("missing.ply")
        ... except symjax.SymjaxError as error:
        ...     print(error)
        cannot read 'missing.ply': No such file or directory
    """


class InvalidArgumentError(SymjaxError):
    """An option has a wrong type or is out of its range, such as sigma <= 0 or too many eigenpairs."""


class InvalidPointsError(SymjaxError):
    """The array is not an (n, 3) array of real numbers."""


class TooFewPointsError(InvalidPointsError):
    """The cloud, or the set of pairs, has too few points."""


class NonfiniteError(InvalidPointsError):
    """Some coordinates are NaN or infinite."""


class DegenerateCloudError(SymjaxError):
    """The points coincide or lie on one line, so they define no mirror plane."""


class SpectrumError(SymjaxError):
    """The eigenpairs of the Laplacian could not be computed."""


class MatchingError(SymjaxError):
    """Too few correspondences were found to fit a plane."""


class MethodError(SymjaxError):
    """A method returned an invalid result: it has no candidate, or its parts contradict each other."""


class FileFormatError(SymjaxError):
    """A file is missing, unreadable, damaged, or of an unsupported format."""


class SymjaxWarning(UserWarning):
    """Base class of all warnings. The result is valid, but the input should be checked.

    Example:
        Turn the warnings of symjax into errors, here because every point is there twice:

        >>> import warnings
        >>> import numpy as np
        >>> import symjax
        >>> points = np.repeat(np.random.default_rng(0).normal(size=(100, 3)), 2, axis=0)
        >>> with warnings.catch_warnings():
        ...     warnings.simplefilter("error", symjax.SymjaxWarning)
        ...     try:
        ...         symjax.detect(points)
        ...     except symjax.SymjaxWarning as warning:
        ...         print(warning)
        100 of 200 points coincide with others and were merged
    """


class PrecisionWarning(SymjaxWarning):
    """The rounding of the input limits the accuracy of the result (float32 far from the origin)."""


class DuplicatePointsWarning(SymjaxWarning):
    """Many points coincide; they were merged."""


class ComponentsWarning(SymjaxWarning):
    """The neighbourhood graph of the cloud is not connected."""
