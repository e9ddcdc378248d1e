"""The uncertainty of an estimated plane: its covariance, standard errors and confidence region."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from symjax.geometry.checks import number
from symjax.geometry.plane import Plane


class Uncertainty(NamedTuple):
    """Covariance of an estimated plane, by the sandwich formula of M-estimators (Godambe).

    Attributes:
        covariance: covariance of three errors: the rotation of the normal towards each of the two `tangents`, in
            radians, and the shift of the plane at `centre`, in the units of the points.
        tangents: two orthonormal vectors in the plane, in rows.
        centre: point at which the shift is measured, where it is least correlated with the rotation. `detect` uses the
            middle of the cloud, and `standard_errors` the weighted mean of the mid-points of the pairs.

    Example:
        >>> estimate = Plane(np.array([0.0, 0.0, 1.0]), np.array(0.0))
        >>> uncertainty = Uncertainty(np.diag([1e-4, 1e-4, 4e-4]), np.eye(3)[:2], np.zeros(3))
        >>> uncertainty.offset
        0.02
        >>> uncertainty.contains(estimate, Plane(np.array([0.0, 0.0, 1.0]), np.array(0.05)))
        True
        >>> uncertainty.contains(estimate, Plane(np.array([0.0, 0.0, 1.0]), np.array(0.06)))
        False
    """

    covariance: Float[np.ndarray, "3 3"]
    tangents: Float[np.ndarray, "2 3"]
    centre: Float[np.ndarray, " 3"]

    @property
    def normal_degrees(self) -> float:
        """Standard error of the normal in degrees: the root mean square of the angle."""
        return float(np.degrees(np.sqrt(np.trace(self.covariance[:2, :2]))))

    @property
    def offset(self) -> float:
        """Standard error of the plane's position at the centre, in the units of the points."""
        return float(np.sqrt(self.covariance[2, 2]))

    def distance(self, estimate: Plane, other: Plane) -> float:
        """Computes the Mahalanobis distance of another plane from the estimate.

        Args:
            estimate: the estimated plane, which this uncertainty belongs to.
            other: another plane, in the same units; the sign of its normal does not matter.

        Returns:
            The distance, without a unit. In one dimension it is the number of standard errors.
        """
        sign = np.sign(other.normal @ estimate.normal)
        normal, offset = sign * other.normal, sign * other.offset
        rotation = self.tangents @ normal
        shift = (offset - normal @ self.centre) - (estimate.offset - estimate.normal @ self.centre)
        # in units of the standard errors, since radians and the units of the points can differ by any factor
        errors = np.sqrt(np.diag(self.covariance))
        errors = np.where(errors > 0, errors, 1.0)
        step = np.append(rotation, shift) / errors
        return float(np.sqrt(step @ np.linalg.pinv(self.covariance / np.outer(errors, errors)) @ step))

    def contains(self, estimate: Plane, other: Plane, *, level: float = 0.95) -> bool:
        """Returns whether another plane lies in the confidence region, whose squared distance is χ² with 3 degrees.

        Args:
            estimate: the estimated plane, which this uncertainty belongs to.
            other: another plane, in the same units.
            level: probability that the region contains the true plane, above 0 and below 1.

        Returns:
            True if the plane lies in the region.

        Raises:
            InvalidArgumentError: if the level is not between 0 and 1.
        """
        level = number("level", level, above=0, below=1)
        return self.distance(estimate, other) ** 2 <= float(chi2.ppf(level, df=3))
