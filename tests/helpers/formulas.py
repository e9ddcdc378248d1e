"""Formulas as printed in textbooks and in the paper, to compare the implementations with."""

import jax.numpy as jnp


def exponential(v, u):
    """Computes the exponential map of the sphere at v: cos‖u‖ v + sin‖u‖ u/‖u‖."""
    square = jnp.sum(u * u)
    length = jnp.sqrt(jnp.where(square > 0, square, 1))
    sinc = jnp.where(square > 0, jnp.sin(length) / length, 1)
    end = jnp.where(square > 0, jnp.cos(length), 1) * v + sinc * u
    return end / jnp.sqrt(jnp.sum(end * end))


def polynomial_f(v, omega, x, y):
    """Computes f_i as printed before Eq. 6: 4vᵀC_i v + ‖x_i − y_i‖² − 4ωvᵀ(x_i + y_i) + 4ω², with C_i = x_i y_iᵀ."""
    square = jnp.sum((x - y) ** 2, axis=1)
    return 4 * (x @ v) * (y @ v) + square - 4 * omega * ((x + y) @ v) + 4 * omega**2
