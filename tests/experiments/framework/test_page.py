"""The page of the studies' results."""

from experiments.framework.catalogue import STUDIES, load
from experiments.framework.page import page
from experiments.framework.provenance import count_models
from tests.experiments.framework.results import section, write_results


def test_a_section_has_command_table_figure_and_provenance(tmp_path):
    lines = [{"what": "area", "value": 0.12345}, {"what": "a|b", "value": 2}]
    write_results(tmp_path, "deviation", lines=lines, figures=(".png", ".pdf"))
    text = page(tmp_path, tmp_path.parent, {})
    text = section(text, "deviation")
    assert "```sh\npython -m experiments.run deviation --size small\n```" in text
    assert "| what | value |\n| --- | --- |\n| area | 0.123 |\n| a\\|b | 2 |" in text
    assert f"]({tmp_path.name}/deviation.png) ([PDF]({tmp_path.name}/deviation.pdf))" in text
    for word in ("seed 5", "62 s", "a processor", "jax 0.8", "commit abc", load("deviation").data):
        assert word in text
    assert load("deviation").title in text


def test_the_page_depends_on_the_files_alone_and_keeps_the_order_of_the_catalogue(tmp_path):
    for name in reversed(STUDIES):
        write_results(tmp_path, name, lines=[{"what": "x", "value": 1.0}])
    text = page(tmp_path, tmp_path, {})
    assert text == page(tmp_path, tmp_path, {})
    assert [line.removeprefix("## ") for line in text.splitlines() if line.startswith("## ")] == list(STUDIES)


def test_a_study_without_results_has_no_section_but_a_reason(tmp_path):
    for name in ("sphere", "gradient", "robustness"):
        write_results(tmp_path, name, lines=[{"what": "x", "value": 1.0}])
    text = page(tmp_path, tmp_path, {"gradient": "failed with status 1", "robustness": "data absent"})
    assert "## sphere" in text
    for name, why in (("gradient", "failed with status 1"), ("robustness", "data absent"), ("planted", "not run")):
        assert f"## {name}" not in text
        assert f"`{name}` ({why})" in text


def test_models_are_counted_and_absent_ones_are_reported(tmp_path):
    rows = [
        {"group": "generated", "model": model, "seed": seed} for model, seed in (("chair", 0), ("chair", 1), ("car", 0))
    ]
    counted = count_models(rows)
    write_results(tmp_path, "robustness", lines=[{"value": 1}], config={"data": "folder", "seeds": 2}, models=counted)
    text = section(page(tmp_path, tmp_path, {}), "robustness")
    assert "Models: 2 generated. THE REAL MODELS WERE ABSENT." in text
    assert "seeds 2" in text
    counted = count_models([*rows, {"group": "exact", "model": "spot", "seed": 0}])
    write_results(tmp_path, "robustness", lines=[{"value": 1}], config={"data": "folder"}, models=counted)
    text = section(page(tmp_path, tmp_path, {}), "robustness")
    assert "Models: 1 exact; 2 generated." in text
    assert "ABSENT" not in text


def test_notes_of_a_study_are_on_the_page(tmp_path):
    write_results(tmp_path, "arena", lines=[{"value": 1}])
    (tmp_path / "arena.md").write_text("| value |\n| --- |\n| 1 |\n\nNot the first in one column.\n")
    assert "| 1 |\n\nNot the first in one column." in section(page(tmp_path, tmp_path, {}), "arena")
