"""How far an estimated plane may be from the true one."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from symjax.geometry.plane import Plane


class Uncertainty(NamedTuple):
    """Covariance of a plane's estimate, by the sandwich formula of M-estimators (Godambe).

    Attributes:
        covariance: of the turn of the normal along the two `tangents`, in radians, and of the plane's distance from
            `centre`, in the units of the points.
        tangents: two unit vectors in the plane, in rows.
        centre: where the distance is taken: the middle of the cloud, where it is least correlated with the turn.
    """

    covariance: Float[np.ndarray, "3 3"]
    tangents: Float[np.ndarray, "2 3"]
    centre: Float[np.ndarray, " 3"]

    @property
    def normal_degrees(self) -> float:
        """Standard error of the normal: root of the mean squared angle, in degrees."""
        return float(np.degrees(np.sqrt(np.trace(self.covariance[:2, :2]))))

    @property
    def offset(self) -> float:
        """Standard error of the plane's distance from the centre, in the units of the points."""
        return float(np.sqrt(self.covariance[2, 2]))

    def distance(self, estimate: Plane, other: Plane) -> float:
        """Mahalanobis distance of another plane from the estimate."""
        sign = np.sign(other.normal @ estimate.normal)
        normal, offset = sign * other.normal, sign * other.offset
        turn = self.tangents @ normal
        shift = (offset - normal @ self.centre) - (estimate.offset - estimate.normal @ self.centre)
        # in standard errors: radians and the points' units differ by any factor
        errors = np.sqrt(np.diag(self.covariance))
        errors = np.where(errors > 0, errors, 1.0)
        step = np.append(turn, shift) / errors
        return float(np.sqrt(step @ np.linalg.pinv(self.covariance / np.outer(errors, errors)) @ step))

    def contains(self, estimate: Plane, other: Plane, *, level: float = 0.95) -> bool:
        """Whether another plane is in the region that holds the true one with probability `level`."""
        return self.distance(estimate, other) ** 2 <= float(chi2.ppf(level, df=3))
