"""Predicted planes of a cube whose scores can be computed by hand."""

import numpy as np

from experiments.data.cases import Case
from experiments.metrics.prediction import Prediction
from experiments.metrics.ranking import Ranking
from symjax.geometry.plane import Plane
from symjax.io.mesh import Mesh

AXES = np.eye(3)
CUBE = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
BOX = Mesh(CUBE, np.array([f[:1] + f[i : i + 2] for f in FACES for i in (1, 2)]), 6)


def tilted(degrees, offset=0.0):
    """Returns a plane whose normal is at an angle, in degrees, from the x axis."""
    angle = np.radians(degrees)
    return Plane(np.array([np.cos(angle), np.sin(angle), 0.0]), np.asarray(offset))


def ranking(*planes):
    normals = np.array([plane.normal for plane in planes]).reshape(-1, 3)
    offsets = np.array([float(plane.offset) for plane in planes])
    return Ranking(normals, offsets, 1.0 - 0.1 * np.arange(len(planes)))


def cube(*truths, name="cube"):
    """Returns the corners of a cube about the origin as a case, with the given true planes."""
    return Case(name, "test", CUBE, truths or (tilted(0.0),), np.sqrt(3.0))


def prediction(answers, truths=()):
    return Prediction(ranking(*answers), cube(*truths))


def moved(one, rng):
    """Returns the same prediction in another pose and in other units."""
    turn, shift, scale = np.linalg.qr(rng.normal(size=(3, 3)))[0], rng.normal(size=3), 7.0
    normals = one.ranking.normals @ turn.T
    posed = Ranking(normals, scale * one.ranking.offsets + normals @ shift, one.ranking.scores)
    planes = tuple(Plane(turn @ n, scale * w + turn @ n @ shift) for n, w in one.case.planes)
    points = scale * one.case.points @ turn.T + shift
    return Prediction(posed, one.case._replace(points=points, planes=planes, diagonal=scale * one.case.diagonal))
