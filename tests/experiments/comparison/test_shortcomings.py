"""What is said where ours is not first."""

import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")


from experiments.baselines.registry import OURS
from experiments.comparison.leaderboard import MEASURES, leaderboard
from experiments.comparison.shortcomings import shortcomings
from tests.experiments.comparison.rows import row


def test_a_sentence_says_where_ours_is_not_first():
    lines = leaderboard([row(OURS, seconds=3.0), row("pca"), row(OURS, 1, angle=40.0, seconds=3.0), row("pca", 1)])
    said = shortcomings(lines, {name: MEASURES[name] for name in ("hit rate", "GTE", "seconds")})
    assert said[0] == "symjax's default is first or tied in 1 of 3 columns."
    assert len(said) == 3
    assert "symjax has 0.5, and PCA has 1;" in said[1]
    assert "symjax has 3, and PCA has 2;" in said[2]
    for sde, sentence in ((2.95, "1 of 1"), (2.7, "0 of 1")):
        lines = leaderboard([row(OURS), row("pca", sde=sde * 1e-4)])
        assert sentence in shortcomings(lines, {"SDE": MEASURES["SDE"]})[0]
    assert "nothing to compare" in shortcomings(leaderboard([row("pca"), row("hruda")]))[0]
