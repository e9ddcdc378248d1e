"""Completing, saving and loading a detection."""

import json

import numpy as np
import pytest

import symjax
from symjax.detection.result import Detection, Pairs
from symjax.errors import FileFormatError, InvalidArgumentError
from symjax.geometry.plane import Plane
from symjax.geometry.uncertainty import Uncertainty
from symjax.method.result import Candidate


@pytest.fixture
def detection(rng):
    points = rng.normal(size=(40, 3))
    plane = Plane(np.array([0.6, 0.8, 0.0]), np.float64(0.3))
    x = points[:5]
    return Detection(
        plane=plane,
        found=True,
        ambiguous=True,
        symmetry="axis",
        planes=(plane,),
        axis=(np.array([0.1, 0.2, 0.3]), np.array([0.0, 0.0, 1.0])),
        uncertainty=Uncertainty(
            np.diag([1e-4, 2e-4, 3e-4]), np.array([[0.8, -0.6, 0.0], [0.0, 0.0, 1.0]]), np.zeros(3)
        ),
        exactness=0.4,
        score=0.5,
        threshold=0.1,
        candidates=(
            Candidate(plane, 0.5, 0.5, 0.4),
            Candidate(Plane(np.array([0.0, 0.0, 1.0]), np.float64(-2.0)), 0.1, 0.1),
        ),
        pairs=Pairs(x, np.asarray(plane.reflect(x)), np.stack([np.arange(5), np.arange(5, 10)], axis=1), np.ones(5)),
        inlier_weight=0.5,
        inlier_fraction=0.9,
        converged=True,
        message="Converged.",
        method="sym-hks",
        sigma=0.02,
        diagonal=4.0,
        seed=7,
        num_points=40,
        used=np.arange(39),
        cleaned=False,
        notes=("1 point was dropped",),
        timings={"fitting": 0.1},
        points=points,
    )


def test_completion_is_the_cloud_and_its_mirror_image(detection):
    whole = detection.complete()
    assert whole.shape == (80, 3)
    np.testing.assert_array_equal(whole[:40], detection.points)
    np.testing.assert_allclose(detection.mirror(whole[40:]), detection.points, atol=1e-12)
    np.testing.assert_allclose(whole @ [0.6, 0.8, 0.0] + whole[np.r_[40:80, 0:40]] @ [0.6, 0.8, 0.0], 0.6, atol=1e-12)


def test_a_saved_detection_is_loaded_as_it_was(detection, tmp_path):
    detection.save(tmp_path / "x.json")
    loaded = symjax.load(tmp_path / "x.json", points=detection.points)
    assert loaded.to_dict() == detection.to_dict()
    np.testing.assert_array_equal(loaded.complete(), detection.complete())
    assert loaded.plane.angle(detection.plane) == 0.0
    with pytest.raises(InvalidArgumentError, match="points"):
        symjax.load(tmp_path / "x.json").complete()


def test_a_file_without_a_detection_is_refused(detection, tmp_path):
    path = tmp_path / "x.json"
    with pytest.raises(FileFormatError, match=r"cannot read .*x\.json"):
        symjax.load(path)
    for text in ("", "[1", "[]", "{}", '{"format": "other"}', '{"format": "symjax detection 1"}'):
        path.write_text(text)
        with pytest.raises(FileFormatError, match=r"x\.json"):
            symjax.load(path)
    for missing in detection.to_dict():
        values = detection.to_dict()
        del values[missing]
        path.write_text(json.dumps(values))
        with pytest.raises(FileFormatError):
            symjax.load(path)


def test_saving_to_a_missing_folder_is_refused(detection, tmp_path):
    with pytest.raises(InvalidArgumentError, match="missing"):
        detection.save(tmp_path / "missing" / "x.json")
