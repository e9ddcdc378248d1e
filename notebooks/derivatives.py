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
# # Learning and shaping through a mirror plane
#
# Many things have a plane of mirror symmetry, and many programs have to find it: from pairs of points (x, y) of which y
# should be the mirror image of x. Most of such pairs are wrong. `symjax.fit_global(x, y, sigma)` finds the plane that
# the most pairs agree on to within a distance σ: the optimum of a robust criterion named L2E.
#
# That plane is the answer of an optimiser, and yet an ordinary differentiable function of what went in. At an optimum
# the gradient of the criterion is zero whatever the pairs are, and that equation says how the optimum moves when the
# pairs move (the implicit function theorem). It costs one 3 × 3 solve; no step of the optimiser is unrolled. So the fit
# can stand in the middle of a larger computation that is itself trained or optimised. Three uses:
#
# 1. the scale σ estimated with the plane, its standard errors, and which pairs pull at it;
# 2. learning which pairs to trust, from nothing but known planes;
# 3. straightening a bent object until it is symmetric.
#
# Everything is simulated, so that the truth is known.

# %%
from functools import partial
from typing import NamedTuple

import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np

import symjax
from symjax import samples
from symjax.objective import squared_residuals
from symjax.planted import planted_pairs
from symjax.samples.sample import random_orthogonal

jax.config.update("jax_enable_x64", True)

# %% [markdown]
# ## 1. The scale, how sure it is, and who pulls at it
#
# A thousand pairs, half of them wrong. Mirror images miss their places by normal noise of 0.01 in each coordinate.
# With `sigma="auto"` that scale and the share ρ of right pairs are estimated together with the plane.

# %%
planted = planted_pairs(np.random.default_rng(0), 1000, 0.5)


def scale(x, y):
    fit = symjax.fit_global(x, y, "auto")
    return fit.sigma, fit


(sigma, fit), by_end = jax.jit(jax.value_and_grad(scale, argnums=(0, 1), has_aux=True))(planted.x, planted.y)
errors = symjax.standard_errors(fit, planted.x, planted.y)
degrees = fit.plane.angle(symjax.Plane(jnp.asarray(planted.normal), jnp.asarray(planted.offset)))
print(f"scale   {sigma:.5f} ± {errors.sigma:.5f}, in truth 0.01")
print(f"share   {fit.inlier_fraction:.3f} ± {errors.inlier_fraction:.3f}, in truth 0.5")
print(f"normal  {degrees:.3f} degrees from the planted one, standard error {errors.plane.normal_degrees:.3f} degrees")

# %% [markdown]
# The same call gave the gradient of σ̂ in all 6000 coordinates. Two things must hold, and do: moving everything changes
# no scale, and enlarging everything enlarges it in proportion.

# %%
moved = by_end[0].sum(axis=0) + by_end[1].sum(axis=0)
enlarged = jnp.sum(planted.x * by_end[0] + planted.y * by_end[1])
print(f"if all points move: {jnp.abs(moved).max():.0e}; if all are enlarged: {enlarged:.5f}")
assert jnp.abs(moved).max() < 1e-9
assert jnp.abs(enlarged / sigma - 1) < 1e-6

# %% [markdown]
# What does one pair do? Let its y move on, away from where the mirror image of x is. Below about 1.7σ̂ the pair pushes σ̂
# down, as it would in any fit. Beyond, it pushes up, then less and less; a pair that is far off has no say at all. Least
# squares would give a straight line upwards.

# %%
miss = planted.y - fit.plane.reflect(planted.x)
length = jnp.linalg.norm(miss, axis=1)
outwards = len(miss) * jnp.sum(by_end[1] * miss, axis=1) / length

fig, ax = plt.subplots(figsize=(6, 3))
for name, which in (("right pairs", planted.inlier), ("wrong pairs", ~planted.inlier)):
    ax.semilogx(length[which] / sigma, outwards[which], ".", label=name)
ax.axhline(0, color="grey", linewidth=0.5)
ax.set(xlabel="distance of y from the mirror image of x, in σ̂", ylabel="∂σ̂ by that distance, × n")
ax.legend()
plt.show()

# %% [markdown]
# ## Gradient descent, from coarse to fine
#
# The other two uses need a descent. Its steps have a given length, which shrinks to nothing: the size of the gradient
# says little here, for it is tiny where the plane is far from all that should pull at it.
#
# A derivative has a blind spot that matters: it says how the plane moves, and not that another plane, elsewhere, is
# about to become the best one. Where σ is large the criterion is smooth, with few optima to jump between; where it is
# small the plane is exact. So both descents begin at a large σ and end at a small one.


# %%
def descend(loss, start, *, sigmas, length, num_steps):
    """Descends from a start while σ goes from the first to the last of two values.

    Args:
        loss: (point, σ) -> value and gradient.
        start: where to begin.
        sigmas: the first σ and the last.
        length: length of the first step; later ones shrink linearly to nothing.
        num_steps: number of steps.

    Returns:
        The last point, and the values on the way.
    """
    point, direction, values = start, np.zeros_like(start), []
    for step, sigma in enumerate(np.geomspace(*sigmas, num_steps)):
        value, gradient = loss(point, sigma)
        direction = 0.5 * direction + 0.5 * np.asarray(gradient) / np.linalg.norm(gradient)
        point = point - length * (1 - step / num_steps) * direction
        values.append(float(value))
    return point, values


# %% [markdown]
# ## 2. Learning which pairs to trust
#
# Pairs come from comparing descriptions of points, and a matcher knows more than the pair: how far apart the two
# descriptions were, whether a second candidate was nearly as good. How much should that count? We need not say: we only
# want good planes, so let the planes say it.
#
# A simulated matcher, for a cloud of 200 pairs: 30 % are right; 45 % agree on *another* plane, 10° to 40° off, as they
# do where an object is nearly symmetric in two ways; 25 % are random. Wrong pairs have a somewhat larger descriptor
# distance, and somewhat oftener a rival; the third feature is noise. Since more pairs follow the other plane than the
# right one, robustness does not help: the other plane *is* the best one, as long as all pairs count alike.

# %%
NUM_PAIRS, NOISE, SIGMA = 200, 0.02, 0.1


class Cloud(NamedTuple):
    """Putative pairs of a cloud; leading axes are those of many clouds.

    Attributes:
        x: one end of every pair.
        y: the other end.
        features: of every pair: log descriptor distance, rivalry of the second candidate, and noise.
        right: which pairs are right.
        normal: normal of the right plane, which passes through the origin.
    """

    x: np.ndarray
    y: np.ndarray
    features: np.ndarray
    right: np.ndarray
    normal: np.ndarray


def simulate(rng):
    normal, beside, _ = random_orthogonal(rng)
    tilt = np.radians(rng.uniform(10, 40))
    plane = symjax.Plane(normal, np.float64(0))
    other = symjax.Plane(np.cos(tilt) * normal + np.sin(tilt) * beside, 0.1 * rng.normal())
    x = rng.normal(size=(NUM_PAIRS, 3)) * rng.uniform(0.3, 0.6, size=3)
    draw = rng.random((NUM_PAIRS, 1))
    y = np.where(draw < 0.3, plane.reflect(x), other.reflect(x)) + NOISE * rng.normal(size=x.shape)
    y = np.where(draw < 0.75, y, rng.permutation(x))
    right = draw[:, 0] < 0.3
    distance = 0.5 * rng.normal(size=NUM_PAIRS) + 0.4 * ~right
    rivalry = jax.scipy.special.expit(rng.normal(size=NUM_PAIRS) + 0.6 * ~right)
    return Cloud(x, y, np.stack([distance, rivalry, rng.normal(size=NUM_PAIRS)], axis=1), right, normal)


def simulated(seed, num_clouds):
    rng = np.random.default_rng(seed)
    return jax.tree.map(lambda *arrays: jnp.stack(arrays), *[simulate(rng) for _ in range(num_clouds)])


# %% [markdown]
# The model is a logistic one: the weight of a pair is a sigmoid of a linear function of its features, four numbers
# altogether. It is trained on 32 clouds whose plane is known; which of their pairs are right it is never told. The loss
# is the squared error of the plane, and every step fits the plane of every cloud anew, without a start. Four times, on
# other clouds each.


# %%
def confidence(model, features):
    return jax.nn.sigmoid(features @ model[:3] + model[3])


def error(model, sigma, cloud):
    weights = confidence(model, cloud.features)
    plane = symjax.fit_global(cloud.x, cloud.y, sigma, weights=weights, num_hypotheses=64, num_polished=4).plane
    return jnp.sum(jnp.cross(plane.normal, cloud.normal) ** 2) + plane.offset**2


@jax.jit
@jax.value_and_grad
def mean_error(model, sigma, clouds):
    return jnp.mean(jax.vmap(partial(error, model, sigma))(clouds))


def train(seed, sigmas):
    mean_error_of_these = partial(mean_error, clouds=simulated(seed, 32))
    return descend(mean_error_of_these, np.zeros(4), sigmas=sigmas, length=0.5, num_steps=25)


seeds = range(1, 5)
trained = {seed: train(seed, (0.6, SIGMA)) for seed in seeds}
for seed, (model, _) in trained.items():
    distance, rivalry, noise, constant = model
    print(f"seed {seed}: distance {distance:.1f}, rivalry {rivalry:.1f}, noise {noise:.1f}, constant {constant:.1f}")

# %% [markdown]
# The test: 150 clouds that no training has seen. Beside the learned weights stand equal ones, the unattainable (a right
# pair counts 1, a wrong one 0), the usual way (the same model, told which pairs are right, by maximum likelihood), and
# the same training at the small σ all along, in the blind spot.

# %%
test = simulated(1000, 150)


@jax.jit
def off(weights):
    """Degrees between the fitted normals of the test clouds and the right ones."""
    fit = partial(symjax.fit_global, num_hypotheses=256, num_polished=8)
    fits = jax.vmap(lambda x, y, w: fit(x, y, SIGMA, weights=w))(test.x, test.y, weights)
    return fits.plane.angle(symjax.Plane(test.normal, jnp.zeros(len(test.x))))


@jax.jit
@jax.value_and_grad
def surprise(model, sigma, clouds):
    odds = clouds.features @ model[:3] + model[3]
    return jnp.mean(jax.nn.softplus(odds) - clouds.right * odds)


def report(name, degrees):
    print(f"{name:22s} median {np.median(degrees):5.2f} degrees, within 2 degrees {np.mean(degrees < 2):4.0%}")
    return degrees


before = report("equal weights", off(jnp.ones_like(test.x[..., 0])))
after = {seed: report(f"learned, seed {seed}", off(confidence(trained[seed][0], test.features))) for seed in seeds}
best = report("right pairs only", off(test.right * 1.0))
for seed in seeds:
    fine, _ = train(seed, (SIGMA, SIGMA))
    report(f"σ = {SIGMA}, seed {seed}", off(confidence(fine, test.features)))
for seed in seeds:
    surprise_of_these = partial(surprise, clouds=simulated(seed, 32))
    told, _ = descend(surprise_of_these, np.zeros(4), sigmas=(1, 1), length=0.5, num_steps=50)
    report(f"told, seed {seed}", off(confidence(told, test.features)))

# %%
fig, ax = plt.subplots(figsize=(6, 3))
share = (np.arange(len(before)) + 1) / len(before)
ax.semilogx(np.sort(before), share, color="tab:grey", label="equal weights")
for seed, degrees in after.items():
    ax.semilogx(np.sort(degrees), share, color="tab:red", alpha=0.6, label="learned, four seeds" if seed == 1 else None)
ax.semilogx(np.sort(best), share, color="black", linestyle=":", label="right pairs only")
ax.set(xlabel="degrees from the right plane", ylabel="share of the test clouds")
ax.legend()
plt.show()
assert max(np.mean(before < 2), 0.5) < min(np.mean(degrees < 2) for degrees in after.values())

# %% [markdown]
# ## 3. Straightening a bent object
#
# A body that is bent to one side and twisted has no mirror plane, and yet its pairs can be known: descriptors that are
# measured along the surface, such as heat kernel signatures, hardly change when it bends. Which deformation makes it
# symmetric again?
#
# The object moves along a smooth field of velocities for a unit of time. The field is any quadratic polynomial in the
# coordinates: 18 numbers, with no notion of a spine or of bending; turned by a rotation it is such a polynomial again.
# The bend below is a field of this kind, so that it can be undone, but nothing tells the descent which one it was.

# %%
FIRST, SECOND = np.triu_indices(3)


def deformed(points, coefficients):
    """Points carried along the quadratic field for a unit of time, by four Runge-Kutta steps."""
    step = 1 / 4

    def velocity(p):
        return (p[:, FIRST] * p[:, SECOND]) @ coefficients

    for _ in range(4):
        k1 = velocity(points)
        k2 = velocity(points + step / 2 * k1)
        k3 = velocity(points + step / 2 * k2)
        k4 = velocity(points + step * k3)
        points = points + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return points


# columns: velocity along x, y, z; rows: its terms xx, xy, xz, yy, yz, zz. Mirror x = 0, spine along z
BEND, TWIST = 0.6, 0.5
BENT = np.zeros((6, 3))
BENT[5, 0], BENT[2, 2] = BEND / 2, -BEND
BENT[4, 0], BENT[2, 1] = -TWIST, TWIST


class Body(NamedTuple):
    """A bent body and its pairs.

    Attributes:
        straight: its points before they were bent, turned as the others are.
        bent: its points.
        x: one end of every pair.
        y: the other end.
        turn: rotation from the body's own axes, x across the mirror and z along the spine.
    """

    straight: np.ndarray
    bent: np.ndarray
    x: np.ndarray
    y: np.ndarray
    turn: np.ndarray


def bent_body(kind, seed, num_pairs=240, wrong=0.3, noise=0.005):
    rng = np.random.default_rng(seed)
    points = samples.generate(kind, num_points=3000, rng=rng).points
    middle, size = (points.max(axis=0) + points.min(axis=0)) / 2, np.ptp(points, axis=0)
    points = (points - middle) / (size.max() / 2)
    if size[1] > size[2]:
        points = points[:, [0, 2, 1]]
    x = rng.permutation(points)[:num_pairs]
    y = x * [-1, 1, 1]
    y = np.where(rng.random((num_pairs, 1)) < wrong, rng.permutation(y), y)
    x, y = (deformed(end, BENT) + noise * rng.normal(size=x.shape) for end in (x, y))
    turn = random_orthogonal(rng)
    return Body(*(array @ turn.T for array in (points, deformed(points, BENT), x, y)), turn)


# %% [markdown]
# What is minimised is the L2E criterion itself at its own optimum: the plane is fitted again in every step, and the
# pairs are carried along. `fit.inlier_fraction` is the share of pairs that the plane mirrors, which is the criterion but
# for constants; its logarithm has a slope even where hardly any pair agrees yet. Wrong pairs need no special care.


# %%
@jax.jit
@partial(jax.value_and_grad, argnums=(0, 2, 3), has_aux=True)
def asymmetry(coefficients, sigma, x, y):
    fit = symjax.fit_global(deformed(x, coefficients), deformed(y, coefficients), sigma)
    return -jnp.log(fit.inlier_fraction), fit


def straighten(body):
    def loss(coefficients, sigma):
        (value, _), (slope, _, _) = asymmetry(coefficients, sigma, body.x, body.y)
        return value, slope

    return descend(loss, np.zeros((6, 3)), sigmas=(0.3, 0.05), length=0.04, num_steps=60)[0]


def distance(points, others):
    return np.sqrt(np.mean(np.sum((points - others) ** 2, axis=1)))


bodies = {kind: bent_body(kind, seed) for seed, kind in enumerate(("human", "quadruped", "fish", "bird"))}
found = {kind: straighten(body) for kind, body in bodies.items()}
for kind, body in bodies.items():
    straightened = deformed(body.bent, found[kind])
    (_, fit), _ = asymmetry(found[kind], 0.05, body.x, body.y)
    degrees = fit.plane.angle(symjax.Plane(jnp.asarray(body.turn[:, 0]), jnp.zeros(())))
    was, now = distance(body.bent, body.straight), distance(straightened, body.straight)
    print(f"{kind:10s} from the straight shape: {was:.3f} before, {now:.3f} after; plane {degrees:.2f} degrees off")

# %%
