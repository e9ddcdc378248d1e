"""Mirror symmetry by registration: ICP aligns a mirror image with the cloud; the composed map is the reflection.

M. Cicconet, D. G. C. Hildebrand, H. Elliott: Finding Mirror Symmetry via Registration, arXiv 1611.05971, 2016, and the
program SymmetryViaRegistration that its authors released.

If a cloud has a mirror plane, then its reflection is the composition of the reflection S in any plane and the rigid
motion (R, t) that aligns the image with the cloud. The normal is the eigenvector of R S for the eigenvalue −1. As in
the program: three starting planes, perpendicular to the principal axes; point-to-point ICP without trimming; at most
100 steps; at most 10 000 points. Ours:

- All coordinates have the same unit, all starting planes pass through the mean, and the score is minus the root mean
  square distance. `as_released` restores the program's choices in these three points. The program's score is the
  strength: 1 / (root mean square distance), divided by the largest of the three. It orders planes alike, but cannot be
  compared between clouds.
- The stopping rule before 100 steps.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import Frame, make_frame, reflect
from experiments.metrics.ranking import Ranking


class Registration(NamedTuple):
    """A rigid motion x → R x + t.

    Attributes:
        rotation: R.
        translation: t.
        rmse: root mean square distance of the moved points from their nearest neighbours.
    """

    rotation: Float[np.ndarray, "3 3"]
    translation: Float[np.ndarray, " 3"]
    rmse: float


@dataclass(frozen=True, kw_only=True)
class Cicconet(Baseline):
    """Three planes, one per principal axis; the score is minus the root mean square distance after ICP, in mean radii.

    Attributes:
        max_points: number of points to which a larger cloud is thinned at random.
        max_steps: limit on the steps of a registration.
        tol: convergence tolerance: relative decrease of the root mean square distance in a step.
        as_released: whether to do what the program does. It divides each coordinate by its own standard deviation, but
            only undoes the shift, so that normals are wrong if the three deviations differ. Its starting planes for the
            second and third axis pass through a point of the plane that was found before, not through the mean. Its
            score is the strength, 1 for the best of the three.
    """

    name: ClassVar[str] = "cicconet"

    max_points: int = 10_000
    max_steps: int = 100
    tol: float = 1e-6
    as_released: bool = False

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = make_frame(points, rng, max_points=self.max_points)
        if self.as_released:
            frame = Frame(frame.points / frame.points.std(axis=0, ddof=1), frame.to_given._replace(scale=1.0))
        tree = cKDTree(frame.points)
        axes = np.linalg.eigh(np.cov(frame.points.T))[1].T[::-1]
        normals, offsets, rmses = np.zeros((3, 3)), np.zeros(3), np.zeros(3)
        point = np.zeros(3)
        for k, axis in enumerate(axes):
            offset = float(axis @ point) if self.as_released else 0.0
            image = reflect(axis, offset, frame.points)
            motion = register(image, tree, max_steps=self.max_steps, tol=self.tol)
            normals[k], point = plane_of_composition(motion, axis, offset)
            offsets[k], rmses[k] = normals[k] @ point, motion.rmse
        return frame.ranking(normals, offsets, strengths(rmses) if self.as_released else -rmses)


def strengths(rmses: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """Returns the scores of the program: 1 / rmse, divided by the largest of them."""
    # the distances of an exact symmetry may be 0
    rmses = np.maximum(rmses, np.finfo(float).eps)
    strength: Float[np.ndarray, " 3"] = rmses.min() / rmses
    return strength


def plane_of_composition(
    motion: Registration, axis: Float[np.ndarray, " 3"], offset: float
) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]:
    """Returns normal and a point of the plane of a composed map: reflection in `axis` · x = `offset`, then a motion.

    On a noisy cloud R S is a rotoreflection with an angle θ ≠ 0. Its eigenvalues are −1 and two of real part cos θ, so
    that the eigenvector for −1 is that of the least eigenvalue of the symmetric part.
    """
    RS = reflect(axis, 0.0, motion.rotation)
    normal = np.linalg.eigh(RS + RS.T)[1][:, 0]
    return normal, (2 * offset * motion.rotation @ axis + motion.translation) / 2


def register(moving: Float[np.ndarray, "m 3"], tree: cKDTree, *, max_steps: int, tol: float) -> Registration:
    """Aligns a cloud with the points of a tree by iterative closest points (ICP), starting from its own pose."""
    R, t, rmse = np.eye(3), np.zeros(3), np.inf
    for _ in range(max_steps):
        distance, nearest = tree.query(moving @ R.T + t)
        before, rmse = rmse, float(np.sqrt((distance**2).mean()))
        if before - rmse <= tol * rmse:
            break
        R, t = rigid_motion(moving, tree.data[nearest])
    return Registration(R, t, rmse)


def rigid_motion(
    x: Float[np.ndarray, "m 3"], y: Float[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, " 3"]]:
    """Returns the rotation R and the translation t that minimise Σ ‖y − R x − t‖² (Kabsch, 1976)."""
    x_mean, y_mean = x.mean(axis=0), y.mean(axis=0)
    U, _, Vt = np.linalg.svd((y - y_mean).T @ (x - x_mean))
    R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return R, y_mean - R @ x_mean
