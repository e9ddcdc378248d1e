"""The sentences about measures in which symjax is not the best."""

import pytest

pytest.importorskip("joblib", reason="the runner needs the extra `arena`")
pytest.importorskip("psutil", reason="the runner needs the extra `arena`")


from experiments.baselines.registry import OURS
from experiments.comparison.leaderboard import MEASURES, leaderboard
from experiments.comparison.shortcomings import shortcomings
from tests.experiments.comparison.rows import row


def test_a_sentence_names_each_measure_in_which_symjax_is_not_the_best():
    lines = leaderboard([row(OURS, seconds=3.0), row("pca"), row(OURS, 1, angle=40.0, seconds=3.0), row("pca", 1)])
    sentences = shortcomings(lines, {name: MEASURES[name] for name in ("hit rate", "GTE", "seconds")})
    assert sentences[0] == "symjax's default is first or tied in 1 of 3 columns."
    assert len(sentences) == 3
    assert "symjax has 0.5, and PCA has 1;" in sentences[1]
    assert "symjax has 3, and PCA has 2;" in sentences[2]
    for sde, sentence in ((2.95, "1 of 1"), (2.7, "0 of 1")):
        lines = leaderboard([row(OURS), row("pca", sde=sde * 1e-4)])
        assert sentence in shortcomings(lines, {"SDE": MEASURES["SDE"]})[0]
    assert "nothing to compare" in shortcomings(leaderboard([row("pca"), row("hruda")]))[0]
