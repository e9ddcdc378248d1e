"""Planted pairs with a competing plane: half of the outliers follow a second plane approximately."""

import numpy as np

from symjax.datasets.planted_pairs import planted_pairs

ROUGH = 0.1
"""Noise of the pairs of the second plane. The planted plane is better if σ is near its own noise, not if σ is large."""


def structured_pairs(seed, num_pairs, outliers=0.9, **options):
    """Returns planted pairs, and the normal and the offset of the plane that half of the outliers follow."""
    rng = np.random.default_rng(seed)
    p = planted_pairs(rng, num_pairs, outliers, **options)
    normal = np.cross(p.normal, rng.normal(size=3)) + 0.5 * p.normal
    normal /= np.linalg.norm(normal)
    offset = float(normal @ p.x.mean(axis=0))
    follows = slice(0, (~p.inlier).sum() // 2)
    x = p.x[follows]
    image = x - 2 * (x @ normal - offset)[:, None] * normal
    p.y[follows] = image + ROUGH * rng.normal(size=x.shape)
    return p, (normal, offset)
