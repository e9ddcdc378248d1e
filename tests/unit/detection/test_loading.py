"""`load` reads back what `save` wrote, and refuses other files."""

import json

import numpy as np
import pytest

from symjax.detection.loading import load
from symjax.errors import FileFormatError
from symjax.geometry.uncertainty import Uncertainty
from tests.helpers.detections import blob, detection_of


def detection(rng):
    uncertainty = Uncertainty(np.diag([1e-4, 2e-4, 3e-4]), np.eye(3)[:2], np.ones(3))
    return detection_of(
        blob(rng, 30),
        weights=(1.0, 0.5, 0.0),
        candidates=3,
        axis=(np.arange(3.0), np.array([0.0, 0.0, 1.0])),
        uncertainty=uncertainty,
        exactness=0.8,
        notes=("a note",),
        timings={"preparing": 0.5},
    )


def test_everything_but_the_points_comes_back(rng, tmp_path):
    saved = detection(rng)
    saved.save(tmp_path / "det.json")
    again = load(tmp_path / "det.json")
    assert again.points is None
    assert again.to_dict() == saved.to_dict()
    assert type(again.candidates[2]) is type(saved.candidates[2])
    np.testing.assert_array_equal(again.uncertainty.covariance, saved.uncertainty.covariance)
    assert again.pairs.rows.dtype.kind == again.used.dtype.kind == "i"


def test_without_pairs_the_arrays_keep_their_shapes(rng, tmp_path):
    detection_of(blob(rng, 30)).save(tmp_path / "det.json")
    again = load(tmp_path / "det.json")
    assert again.pairs.x.shape == again.pairs.y.shape == (0, 3)
    assert again.pairs.rows.shape == (0, 2)


def test_given_its_points_it_completes_the_object_as_before(rng, tmp_path):
    saved = detection(rng)
    saved.save(tmp_path / "det.json")
    again = load(tmp_path / "det.json", points=saved.points)
    np.testing.assert_array_equal(again.complete(), saved.complete())


@pytest.mark.parametrize("missing", ["plane", "pairs", "used", "candidates", "score"])
def test_a_file_that_lacks_something_is_refused(missing, rng, tmp_path):
    values = detection(rng).to_dict()
    del values[missing]
    path = tmp_path / "det.json"
    path.write_text(json.dumps(values), encoding="utf-8")
    with pytest.raises(FileFormatError, match="is not a complete detection"):
        load(path)


@pytest.mark.parametrize(
    ("text", "message"),
    [("{", "is not JSON"), ("[1, 2]", "not written by"), ('{"format": "another"}', "not written by")],
)
def test_another_file_is_refused(text, message, tmp_path):
    path = tmp_path / "det.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(FileFormatError, match=message):
        load(path)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileFormatError, match=r"cannot read .*nowhere\.json"):
        load(tmp_path / "nowhere.json")
