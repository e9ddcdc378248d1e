"""Hit rates and the area under their curve."""

import numpy as np
import pytest

from experiments.metrics import hits, shrec
from experiments.metrics.deviation import Deviation
from symjax.errors import InvalidArgumentError


def test_hit_rates_and_area_of_known_angles():
    deviations = [Deviation(angle, 0.0) for angle in (0.5, 1.5, 4.0, 9.0, 30.0, 60.0)]
    assert hits.hit_rates(deviations) == {1.0: 1 / 6, 2.0: 2 / 6, 5.0: 3 / 6, 10.0: 4 / 6, 45.0: 5 / 6}
    grid = np.linspace(0, 45, 200_001)
    steps = np.mean([grid > d.angle for d in deviations], axis=0)
    assert hits.area(deviations) == pytest.approx(np.trapezoid(steps, grid) / 45, abs=1e-5)
    assert hits.area(deviations) == pytest.approx(1 - 45 / (45 * 6) - 1 / 6, abs=1e-12)


def test_exact_planes_hit_at_all_angles_and_have_area_one():
    assert set(hits.hit_rates([Deviation(0.0, 0.0)] * 3).values()) == {1.0}
    assert hits.area([Deviation(0.0, 0.0)] * 3) == 1.0


@pytest.mark.parametrize("miss", [Deviation(0.0, 0.02), Deviation(90.0, 1.0), Deviation(np.nan, np.nan)])
def test_too_large_an_offset_error_or_no_plane_is_a_miss(miss):
    assert set(hits.hit_rates([miss, Deviation(0.0, 0.019)]).values()) == {0.5}
    assert hits.area([miss, Deviation(0.0, 0.019)]) == 0.5


def test_empty_lists_are_refused():
    with pytest.raises(InvalidArgumentError, match="at least one"):
        hits.area([])
    with pytest.raises(InvalidArgumentError, match="at least one"):
        shrec.scores([])
