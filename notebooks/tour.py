# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A tour of symjax
#
# This notebook detects the mirror plane of a scan. Then it uses the estimator by itself: a sweep over σ and starts, and
# derivatives. The file is in the percent format of [jupytext](https://jupytext.readthedocs.io): open it in Jupyter with
# the jupytext extension, or run it as a script.

# %%
import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

import symjax
from symjax import datasets
from symjax.datasets.planted_pairs import planted_pairs
from symjax.geometry.directions import fibonacci

jax.config.update("jax_enable_x64", True)

# %% [markdown]
# ## The mirror plane of a scan
#
# The scan is a generated animal in a random pose. A fifth of its points is missing, and there is one outlier for every
# two remaining points. The true plane is known.

# %%
rng = np.random.default_rng(1)
animal = datasets.pose(datasets.generate("quadruped", num_points=4000, rng=rng), rng)
scan = datasets.corrupt(animal.points, rng, missing=0.2, noise=0.002, outliers=0.5).points

detection = symjax.detect(scan)
truth = symjax.Plane(animal.normals[0], animal.offsets[0])
print("normal", detection.plane.normal, "offset", detection.plane.offset)
print(f"found {detection.found}: score {detection.score:.3f}, threshold {detection.threshold:.3f}")
print(f"{float(detection.plane.angle(truth)):.2f} degrees from the true plane,")
print(f"standard error {detection.uncertainty.normal_degrees:.2f} degrees")

# %% [markdown]
# The pairs are the evidence for the plane. A pair has a weight near 1 if the mirror image of its point lies on the
# surface, and a weight near 0 if the matching part of the surface is missing.

# %%
fig, ax = plt.subplots(figsize=(6, 2.5))
ax.hist(detection.pairs.weight, bins=20)
ax.set(xlabel="weight of a pair", ylabel="pairs")
plt.show()

# %% [markdown]
# Not every object has exactly one mirror plane. The detection gives the type of the symmetry.

# %%
for kind in ("block", "drum", "tree"):
    detected = symjax.detect(datasets.generate(kind, num_points=3000, rng=0).points)
    print(f"{kind:6s} {detected.symmetry}, ambiguous {detected.ambiguous}, score {detected.score:.2f}")

# %%
figure = detection.plot()
print(len(figure.data), "traces; figure.show() opens the interactive figure")

# %% [markdown]
# ## The estimator by itself: a sweep over σ and starts
#
# Of these 400 pairs with a known mirror plane, 80 % are outliers. One compiled call fits them with 12 scales σ and
# 32 starts for each.

# %%
pairs = planted_pairs(np.random.default_rng(0), 400, 0.8, "isotropic")
sigmas = jnp.geomspace(0.01, 0.6, 12)
fits = symjax.sweep(pairs.x, pairs.y, sigmas, fibonacci(32))
best = symjax.best(fits)
planted = symjax.Plane(jnp.asarray(pairs.normal), jnp.asarray(pairs.offset))
angles = fits.plane.angle(planted)

fig, ax = plt.subplots(figsize=(6, 3))
ax.loglog(sigmas, angles, ".", color="tab:blue", alpha=0.3)
ax.loglog(sigmas, best.plane.angle(planted), "o-", color="tab:red", label="lowest loss")
ax.set(xlabel="σ", ylabel="degrees from the planted plane")
ax.legend()
plt.show()

# %% [markdown]
# ## Derivatives of the plane
#
# How much does the normal change when one point moves? The fit is differentiated by the implicit function theorem,
# which takes one 3 × 3 solve and no unrolling of the solver. Outliers have almost no influence: the method is robust.

# %%
x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)


def normal(x):
    return symjax.fit_plane(x, y, 0.05, planted.normal).plane.normal


influence = jnp.linalg.norm(jax.jit(jax.jacrev(normal))(x), axis=(0, 2))
print("median influence of an inlier  ", float(jnp.median(influence[pairs.inlier])))
print("median influence of an outlier ", float(jnp.median(influence[~pairs.inlier])))
assert jnp.median(influence[pairs.inlier]) > 1e3 * jnp.median(influence[~pairs.inlier])
