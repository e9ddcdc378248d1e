"""A body of revolution and handles for it: coarse evidence of a symmetry, or against it."""

import numpy as np


def vessel(num_points, rng):
    """A closed cylinder of radius 1 and height 2 about the z axis."""
    z, turn = rng.uniform(-1, 1, num_points), rng.uniform(0, 2 * np.pi, num_points)
    side = np.column_stack([np.cos(turn), np.sin(turn), z])
    radius = np.sqrt(rng.uniform(0, 1, num_points))
    caps = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.sign(z)])
    return np.where(rng.uniform(size=(num_points, 1)) < 2 / 3, side, caps)


def handle(num_points, rng, *, degrees=0.0, size=0.6):
    """Half a ring that stands out from the cylinder, in the direction of x turned by an angle about the z axis."""
    turn, around = rng.uniform(-np.pi / 2, np.pi / 2, num_points), rng.uniform(0, 2 * np.pi, num_points)
    radius = size + 0.1 * np.cos(around)
    x, y, z = 1 + radius * np.cos(turn), 0.1 * np.sin(around), radius * np.sin(turn)
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y, z])
