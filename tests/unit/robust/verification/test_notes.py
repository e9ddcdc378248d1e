"""Every doubt has a sentence."""

import numpy as np
import pytest

from symjax.geometry.plane import Plane
from symjax.robust.surface import estimate_surface
from symjax.robust.verification.classification import Classification
from symjax.robust.verification.contradiction import NO_CONTRADICTION, Contradiction
from symjax.robust.verification.evidence import Evidence
from symjax.robust.verification.notes import notes

PLANE = Plane(np.array([1.0, 0.0, 0.0]), np.float64(0.0))
ONE = Classification(0.4, "one plane", False, None, (PLANE,))


def notes_of(contradiction, result=ONE, *, one_sided=False, complete=False):
    surface = estimate_surface(np.random.default_rng(0).normal(size=(99, 3)))
    return notes(Evidence(surface, one_sided, complete, (PLANE,), (contradiction,)), result)


def test_a_complete_cloud_needs_no_note():
    assert notes_of(NO_CONTRADICTION, complete=True) == ()


@pytest.mark.parametrize(
    ("contradiction", "result", "options", "words"),
    [
        (NO_CONTRADICTION, ONE, {"one_sided": True}, "scan from one side"),
        (
            Contradiction(0.1, 0.1, 0.0),
            ONE._replace(symmetry="none", refuted=True),
            {},
            "10.0% of the cloud to places where",
        ),
        (Contradiction(0.28, 0.0, 0.9), ONE, {}, "28% of the cloud has no counterpart"),
        (NO_CONTRADICTION, ONE._replace(unconfirmed=1), {}, "another plane agrees nearly as well"),
        (NO_CONTRADICTION, ONE._replace(unconfirmed=2), {}, "2 other planes agree nearly as well"),
    ],
)
def test_every_doubt_has_a_sentence(contradiction, result, options, words):
    (note,) = notes_of(contradiction, result, **options)
    assert words in note
