"""All experiments in turn, and the page of what they left."""

import dataclasses
import json
from datetime import UTC, datetime

import pytest

from experiments.framework import page, study
from experiments.framework import run_all as everything
from experiments.framework.catalogue import CONTENTS


def left(out, name, *, lines, config=None, models=None, figures=()):
    """Files as an experiment leaves them."""
    about = {
        "command": f"python -m experiments.{name} --size small",
        "size": "small",
        "config": config or {"seed": 5},
        "commit": "abc",
        "versions": {"python": "3.11", "jax": "0.8"},
        "machine": {"system": "Linux", "cpu": "a processor", "cores": 2},
        "started": "2026-01-02T03:04:05+00:00",
        "wall_seconds": 61.7,
        "models": models or {},
        "summary": lines,
    }
    (out / f"{name}.json").write_text(json.dumps(about))
    (out / f"{name}.md").write_text(study.markdown(lines))
    for suffix in figures:
        (out / f"{name}{suffix}").write_bytes(b"picture")


def section(page, name):
    return page.split(f"\n## {name}\n")[1].split("\n## ")[0]


def test_a_section_has_command_table_figure_and_provenance(tmp_path):
    lines = [{"what": "area", "value": 0.12345}, {"what": "a|b", "value": 2}]
    left(tmp_path, "deviation", lines=lines, figures=(".png", ".pdf"))
    text = page.page(tmp_path, tmp_path.parent, {})
    text = section(page, "deviation")
    assert "```sh\npython -m experiments.studies.paper.deviation --size small\n```" in text
    assert "| what | value |\n| --- | --- |\n| area | 0.123 |\n| a\\|b | 2 |" in text
    assert f"]({tmp_path.name}/deviation.png) ([PDF]({tmp_path.name}/deviation.pdf))" in text
    for word in ("seed 5", "62 s", "a processor", "jax 0.8", "commit abc", CONTENTS["deviation"].data):
        assert word in text
    assert (study.PROJECT / "experiments" / "deviation.py").read_text().splitlines()[0].strip('"') in text


def test_the_page_depends_on_the_files_alone_and_keeps_the_order(tmp_path):
    for name in reversed(CONTENTS):
        left(tmp_path, name, lines=[{"what": "x", "value": 1.0}])
    text = page.page(tmp_path, tmp_path, {})
    assert text == page.page(tmp_path, tmp_path, {})
    assert [line.removeprefix("## ") for line in text.splitlines() if line.startswith("## ")] == list(CONTENTS)


def test_what_was_not_run_or_failed_or_had_no_data_has_no_section(tmp_path):
    for name in ("sphere", "checks", "road"):
        left(tmp_path, name, lines=[{"what": "x", "value": 1.0}])
    text = page.page(tmp_path, tmp_path, {"checks": "failed with status 1", "road": "data absent"})
    assert "## sphere" in text
    for name, why in (("checks", "failed with status 1"), ("road", "data absent"), ("planted", "not run")):
        assert f"## {name}" not in text
        assert f"`{name}` ({why})" in text


def test_models_are_counted_and_absent_ones_said_loudly(tmp_path):
    rows = [
        {"group": "generated", "model": model, "seed": seed} for model, seed in (("chair", 0), ("chair", 1), ("car", 0))
    ]
    of = study.models(rows)
    left(tmp_path, "road", lines=[{"value": 1}], config={"data": "folder", "seeds": 2}, models=of)
    text = section(page.page(tmp_path, tmp_path, {}), "road")
    assert "Models: 2 generated. THE REAL MODELS WERE ABSENT." in text
    assert "seeds 2" in text
    of = study.models([*rows, {"group": "exact", "model": "spot", "seed": 0}])
    left(tmp_path, "road", lines=[{"value": 1}], config={"data": "folder"}, models=of)
    text = section(page.page(tmp_path, tmp_path, {}), "road")
    assert "Models: 1 exact; 2 generated." in text
    assert "ABSENT" not in text


def test_what_an_experiment_says_under_its_table_is_kept(tmp_path):
    left(tmp_path, "arena", lines=[{"value": 1}])
    (tmp_path / "arena.md").write_text("| value |\n| --- |\n| 1 |\n\nNot the first in one column.\n")
    assert "| 1 |\n\nNot the first in one column." in section(page.page(tmp_path, tmp_path, {}), "arena")


def test_the_contents_are_all_scripts_and_no_others():
    folder = study.PROJECT / "experiments"
    scripts = {
        path.stem for path in folder.glob("*.py") if "(__file__, __doc__, SIZES" in path.read_text(encoding="utf-8")
    }
    assert scripts == set(CONTENTS)


def test_no_path_of_a_machine_is_kept():
    @dataclasses.dataclass
    class Config:
        data: str = str(study.PROJECT / "experiments" / "out")
        methods: str = "a,b"

    about = study.provenance("command", Config(), "small", datetime.now(UTC), 1.0)
    assert about["config"] == {"data": "experiments/out", "methods": "a,b"}
    for path in (study.PROJECT / "experiments" / "out").glob("*.json"):
        config = json.loads(path.read_text())["config"]
        assert not [value for value in config.values() if isinstance(value, str) and value.startswith("/")]


def test_one_experiment_runs_in_its_own_process(tmp_path, capsys):
    everything.main(["--size", "small", "--only", "sphere", "--out", str(tmp_path)])
    said = capsys.readouterr().out
    assert "[1/1] sphere: done, " in said
    assert "1 of 1 in " in said
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "area / 4 pi" in section(page, "sphere")
    assert "`checks` (not run)" in page


def test_a_failure_is_said_and_does_not_stop_the_rest(tmp_path, capsys, monkeypatch):
    outcomes = {"checks": "failed with status 2", "sphere": "", "road": "data absent"}
    asked = []

    def run(name, size, out, environment):
        asked.append((name, size))
        left(out, name, lines=[{"value": 1}])
        return outcomes[name]

    monkeypatch.setattr(everything, "_run", run)
    with pytest.raises(SystemExit) as stop:
        everything.main(["--size", "full", "--only", "checks,sphere,road", "--out", str(tmp_path)])
    assert stop.value.code == 1
    assert asked == [("checks", "full"), ("sphere", "full"), ("road", "full")]
    assert capsys.readouterr().out.splitlines()[-2:] == ["checks: failed with status 2", "road: data absent"]
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "## sphere" in text
    assert "## checks" not in text


def test_absent_data_is_no_failure(tmp_path, monkeypatch):
    monkeypatch.setattr(everything, "_run", lambda *_: "data absent")
    everything.main(["--size", "small", "--only", "sphere", "--out", str(tmp_path)])


@pytest.mark.parametrize(("status", "outcome"), [(0, ""), (1, "failed with status 1"), (3, "data absent")])
def test_the_exit_status_says_what_became_of_an_experiment(tmp_path, monkeypatch, status, outcome):
    finished = type("Finished", (), {"returncode": status})
    monkeypatch.setattr(everything.subprocess, "run", lambda *_, **__: finished)
    assert everything._run("sphere", "small", tmp_path, {}) == outcome


def test_an_unknown_name_is_refused(tmp_path, capsys):
    with pytest.raises(SystemExit):
        everything.main(["--size", "small", "--only", "nothing", "--out", str(tmp_path)])
    assert "'nothing' is unknown" in capsys.readouterr().err
