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
# From a scan to its mirror plane; then the estimator by itself: sweeps over σ and starts, and derivatives.
# This file is a notebook in [jupytext](https://jupytext.readthedocs.io)'s percent format: open it in Jupyter with the
# jupytext extension, or run it as a script.

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
# ## A scan, and its plane
#
# A generated animal in a random pose, a fifth of it missing, and a stray point for every two. Its true plane is known.

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
# The pairs are the evidence: points whose mirror images lie on the surface have a weight near 1, those whose partners
# are missing a weight near 0.

# %%
fig, ax = plt.subplots(figsize=(6, 2.5))
ax.hist(detection.pairs.weight, bins=20)
ax.set(xlabel="weight of a pair", ylabel="pairs")
plt.show()

# %% [markdown]
# Not every object has one plane. The answer says what it has.

# %%
for kind in ("block", "drum", "tree"):
    answer = symjax.detect(datasets.generate(kind, num_points=3000, rng=0).points)
    print(f"{kind:6s} {answer.symmetry}, ambiguous {answer.ambiguous}, score {answer.score:.2f}")

# %%
figure = detection.plot()
print(len(figure.data), "traces; figure.show() opens the interactive picture")

# %% [markdown]
# ## The estimator by itself: a sweep over σ and starts
#
# Planted pairs of which 80 % are wrong: 12 scales σ times 32 starts in one compiled call.

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
# ## Derivatives of the answer
#
# How much does the normal move when one point moves? The answer is differentiated by the implicit function theorem: one
# 3 × 3 solve, no unrolling. Outliers have no influence, which is what robustness means.

# %%
x, y = jnp.asarray(pairs.x), jnp.asarray(pairs.y)


def normal(x):
    return symjax.fit_plane(x, y, 0.05, planted.normal).plane.normal


influence = jnp.linalg.norm(jax.jit(jax.jacrev(normal))(x), axis=(0, 2))
print("median influence of a right pair ", float(jnp.median(influence[pairs.inlier])))
print("median influence of an outlier   ", float(jnp.median(influence[~pairs.inlier])))
assert jnp.median(influence[pairs.inlier]) > 1e3 * jnp.median(influence[~pairs.inlier])
