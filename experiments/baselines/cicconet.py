"""Mirror symmetry by registration: the mirror image of a cloud is moved onto the cloud, and the two maps are composed.

M. Cicconet, D. G. C. Hildebrand, H. Elliott: Finding Mirror Symmetry via Registration, arXiv 1611.05971, 2016, and the
program SymmetryViaRegistration that its authors released.

A reflection S about any plane, followed by the rigid motion (R, t) that takes the image onto the cloud, is the
reflection of the cloud, if it has one: its normal is the eigenvector of R S at −1, whatever the first plane was. As in
the program: first planes across the three principal axes, point-to-point ICP without trimming, 100 iterations, at most
10 000 points. Ours: one unit for all coordinates, all first planes through the mean, and minus the root mean square
distance as the score (`as_released` undoes these three), and when to stop before 100. The program's strength is
1 / (root mean square distance), divided by the largest of the three: the same order, but no scale to compare clouds by.
"""

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import Frame, framed, reflect
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
    """Three planes, one for each principal axis, by minus the root mean square distance of moved images, in mean radii.

    Attributes:
        num_points: most points that are used, drawn at random.
        max_steps: most iterations of a registration.
        tolerance: a registration ends once its distance falls by less than this share.
        as_released: what the program does. Each coordinate is divided by its own standard deviation, and planes are
            only shifted back, so that normals are wrong where the three differ. The first planes of the second and
            third axis pass through the plane that was found before, not through the mean. The score is the strength,
            1 for the strongest of the three.
    """

    name: ClassVar[str] = "cicconet"

    num_points: int = 10_000
    max_steps: int = 100
    tolerance: float = 1e-6
    as_released: bool = False

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks planes of a cloud, see `Baseline.rank`."""
        frame = framed(points, rng, most=self.num_points)
        if self.as_released:
            frame = Frame(frame.points / frame.points.std(axis=0, ddof=1), frame.to_given._replace(scale=1.0))
        tree = cKDTree(frame.points)
        axes = np.linalg.eigh(np.cov(frame.points.T))[1].T[::-1]
        normals, offsets, rmses = np.zeros((3, 3)), np.zeros(3), np.zeros(3)
        point = np.zeros(3)
        for k, axis in enumerate(axes):
            offset = float(axis @ point) if self.as_released else 0.0
            image = reflect(axis, offset, frame.points)
            found = register(image, tree, max_steps=self.max_steps, tolerance=self.tolerance)
            normals[k], point = mirror(found, axis, offset)
            offsets[k], rmses[k] = normals[k] @ point, found.rmse
        return frame.ranking(normals, offsets, strengths(rmses) if self.as_released else -rmses)


def strengths(rmses: Float[np.ndarray, " 3"]) -> Float[np.ndarray, " 3"]:
    """What the program scores planes by: 1 / rmse, divided by the largest."""
    # an exact symmetry has no distances but those of rounding
    rmses = np.maximum(rmses, np.finfo(float).eps)
    return rmses.min() / rmses


def mirror(
    motion: Registration, axis: Float[np.ndarray, " 3"], offset: float
) -> tuple[Float[np.ndarray, " 3"], Float[np.ndarray, " 3"]]:
    """Normal and a point of the plane whose reflection is that about `axis` · x = `offset`, followed by the motion.

    With noise R S is a rotation about some axis and a reflection across it. Its eigenvalues are −1 and two of real
    part cos θ, so that the eigenvector at −1 is the least of the symmetric part.
    """
    RS = reflect(axis, 0.0, motion.rotation)
    normal = np.linalg.eigh(RS + RS.T)[1][:, 0]
    return normal, (2 * offset * motion.rotation @ axis + motion.translation) / 2


def register(moving: Float[np.ndarray, "m 3"], tree: cKDTree, *, max_steps: int, tolerance: float) -> Registration:
    """The motion of a cloud onto the points of a tree, by iterated closest points from where it is."""
    R, t, rmse = np.eye(3), np.zeros(3), np.inf
    for _ in range(max_steps):
        distance, nearest = tree.query(moving @ R.T + t)
        before, rmse = rmse, float(np.sqrt((distance**2).mean()))
        if before - rmse <= tolerance * rmse:
            break
        R, t = rigid(moving, tree.data[nearest])
    return Registration(R, t, rmse)


def rigid(
    x: Float[np.ndarray, "m 3"], y: Float[np.ndarray, "m 3"]
) -> tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, " 3"]]:
    """Rotation R and translation t that minimise Σ ‖y − R x − t‖² (Kabsch, 1976)."""
    x_mean, y_mean = x.mean(axis=0), y.mean(axis=0)
    U, _, Vt = np.linalg.svd((y - y_mean).T @ (x - x_mean))
    R = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt
    return R, y_mean - R @ x_mean
