"""EM-ICP between a cloud and its mirror image, by the package pyclarcs: `pip install pyclarcs==0.4.4`.

B. Combès et al., *Automatic symmetry plane estimation of bilateral objects in point clouds*, CVPR 2008. The method runs
all stages of the package's command `clarcs symplane`: the best principal plane, trimmed ICP, EM-ICP with falling scale,
and EM-ICP with doubly stochastic weights.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from jaxtyping import Float
from scipy.spatial import KDTree

from experiments.baselines.baseline import Baseline
from experiments.baselines.frame import make_frame
from experiments.baselines.pca import mean_residual
from experiments.metrics.ranking import Ranking

DIAGONAL = 200.0
"""Diagonal to which clouds are scaled: the package's scales, 5 to 0.25, are millimetres on a human head."""


@dataclass(frozen=True, kw_only=True)
class Pyclarcs(Baseline):
    """The plane that the package returns; its score is minus the mean distance of mirror images, in mean radii.

    Attributes:
        diagonal: diagonal of the bounding box to which the cloud is scaled.
    """

    name: ClassVar[str] = "pyclarcs"

    diagonal: float = DIAGONAL

    def rank(self, points: Float[np.ndarray, "n 3"], rng: np.random.Generator) -> Ranking:
        """Ranks a single plane, see `Baseline.rank`; `rng` seeds the package's subsampling.

        Raises:
            ImportError: if the package is not installed.
        """
        try:
            from pyclarcs.coarse import coarse_symmetry
            from pyclarcs.fine import em_icp_sym, em_icp_sym_corres
            from pyclarcs.principal_axes import best_principal_axis_plane
        except ImportError as error:
            raise ImportError("pyclarcs is not installed: pip install pyclarcs==0.4.4") from error

        frame = make_frame(points, rng, max_points=len(points))
        scale = self.diagonal / float(np.linalg.norm(np.ptp(frame.points, axis=0)))
        scaled = scale * frame.points
        plane = coarse_symmetry(scaled, best_principal_axis_plane(scaled), seed=int(rng.integers(2**31)))
        plane = em_icp_sym_corres(scaled, em_icp_sym(scaled, plane))
        normal, offset = np.asarray(plane.n), plane.d / scale
        score = -mean_residual(KDTree(frame.points), normal, offset)
        return frame.ranking(normal[None], np.array([offset]), np.array([score]))
