"""Made-up rows of results, for the tests of the leaderboard, the curves and the plan."""

import numpy as np

from experiments.comparison import evaluate


def row(method="pca", item=0, condition="clean", angle=1.0, offset=0.0, **changed):
    """Returns a row with the true plane x = 0 and one predicted plane at an angle and offset from it."""
    turned = np.radians(angle)
    steps = range(evaluate.STEPS + 1)
    values = {
        **{"method": method, "benchmark": "procedural", "item": item, "condition": condition, "seed": 0},
        **{"num_points": 100, "data": "", "name": "block", "group": "generated", "raised": "", "seconds": 2.0},
        **{"truths": [[1.0, 0.0, 0.0, 0.0]], "centre": [0.0, 0.0, 0.0], "diagonal": 1.0},
        "planes": [[np.cos(turned), np.sin(turned), 0.0, offset, 0.9]],
        **{"accepted": [True], "found": True, "ambiguous": False, "angle": angle, "offset_error": offset},
        **{"gte": 0.02, "gte_squared": 4e-4, "sde": 3e-4},
        **{"funk": [int(angle < step) for step in steps], "funk_paper": [int(angle < step) for step in steps]},
    }
    return values | changed


def unanswered(**changed):
    """Returns the row of a method that exceeded its time limit."""
    return row(**changed) | evaluate.NO_ANSWER | {"raised": "timeout: more than 9 s"}
