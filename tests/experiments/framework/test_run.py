"""The command `experiments.run`: one study, several or all, and their results."""

import importlib
import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from experiments import run, studies
from experiments.framework import catalogue, options, run_all
from experiments.framework.catalogue import STUDIES, load
from experiments.framework.project import PROJECT, RESULTS, results_folder
from experiments.framework.run_study import FAILED, NOT_MEASURED, run_study
from experiments.framework.study import Study
from tests.experiments.framework.results import section, write_results


@dataclass(frozen=True)
class Config:
    seed: int = 0
    share: float = 0.5
    name: str = "50 % of all"


def study_of(rows, **changed):
    """A study whose result is these rows."""
    sizes = {"full": Config(), "small": Config(seed=1)}
    return Study("made_up", "A title.\n\nA text.", sizes, lambda config: rows, lambda rows: rows, **changed)


def test_every_study_is_in_the_catalogue_by_its_name():
    assert [load(name).name for name in STUDIES] == list(STUDIES)
    found = set()
    for path in Path(studies.__path__[0]).rglob("*.py"):
        module = importlib.import_module(".".join(path.relative_to(PROJECT).with_suffix("").parts))
        found |= {value.name for value in vars(module).values() if isinstance(value, Study)}
    assert found == set(STUDIES)


def test_every_study_has_a_title_data_and_both_sizes():
    for study in map(load, STUDIES):
        assert study.title.endswith((".", ")."))
        assert study.data
        assert list(study.sizes) == ["full", "small"]


def test_no_study_is_a_script_of_its_own():
    workers = {"studies/speed/memory.py", "execution/serving.py", "studies/speed/random_starts.py", "run.py"}
    folder = PROJECT / "experiments"
    commands = {path.relative_to(folder).as_posix() for path in folder.rglob("*.py") if "__main__" in path.read_text()}
    assert commands == workers
    assert not list(folder.rglob("__main__.py"))


def test_small_results_have_a_folder_of_their_own():
    assert options.parse(load("planted"), []).folder == RESULTS == results_folder("full")
    small = options.parse(load("planted"), ["--size", "small"]).folder
    assert small == RESULTS / "small"
    # so has the file of results that the studies of the arena share
    full, small = (options.parse(load("arena"), ["--size", size]).config.results for size in ("full", "small"))
    assert (full, small) == (str(RESULTS / "arena.jsonl"), str(RESULTS / "small" / "arena.jsonl"))


def test_a_small_run_never_replaces_the_results_of_a_full_one(tmp_path, capsys):
    arguments = ["--out", str(tmp_path)]
    assert run_study(study_of([{"value": 1}]), arguments) == 0
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    assert run_study(study_of([{"value": 2}]), ["--size", "small", *arguments]) == FAILED
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert "HOLDS THE RESULTS OF A FULL RUN" in capsys.readouterr().err
    assert run_study(study_of([{"value": 3}]), arguments) == 0
    assert (tmp_path / "made_up.csv").read_text().split() == ["value", "3"]


def test_a_study_writes_rows_table_and_provenance(tmp_path, capsys):
    study = study_of([{"value": 1}], notes=lambda rows: f"{len(rows)} row.")
    assert run_study(study, ["--seed", "7", "--name", "a b", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "made_up.md").read_text() == "| value |\n| --- |\n| 1 |\n\n1 row.\n"
    about = json.loads((tmp_path / "made_up.json").read_text())
    assert about["command"] == f"python -m experiments.run made_up --seed 7 --name 'a b' --out {tmp_path}"
    assert (about["config"], about["size"]) == ({"seed": 7, "share": 0.5, "name": "a b"}, "full")
    assert "made_up (full): 1 rows" in capsys.readouterr().out


def test_a_study_without_rows_writes_nothing(tmp_path, capsys):
    assert run_study(study_of([]), ["--out", str(tmp_path)]) == NOT_MEASURED
    assert "NOTHING WAS MEASURED" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_help_names_the_options_with_their_defaults(capsys):
    with pytest.raises(SystemExit) as stop:
        run_study(study_of([]), ["--help"])
    assert stop.value.code == 0
    text = capsys.readouterr().out
    assert "python -m experiments.run made_up" in text
    assert "default: 0 (full), 1 (small)" in text
    assert "50 % of all" in text


def test_the_command_lists_the_studies(capsys, monkeypatch):
    assert run.main(["--help"]) == 0
    assert run.main([]) == run.WRONG_USAGE
    listed = {"sphere": STUDIES["sphere"], "gone": "no_such_module:STUDY"}
    monkeypatch.setattr(catalogue, "STUDIES", listed)
    monkeypatch.setattr(run, "STUDIES", listed)
    capsys.readouterr()
    assert run.main(["list"]) == 0
    first, second = capsys.readouterr().out.splitlines()
    assert first.startswith("sphere  The Laplacian")
    assert second.startswith("gone    cannot be run here: ")


def test_an_unknown_name_is_refused_before_anything_runs(capsys, monkeypatch):
    monkeypatch.setattr(run, "run_all", None)
    assert run.main(["sphere", "lanscape"]) == run.WRONG_USAGE
    assert "there is no study 'lanscape': did you mean 'landscape'?" in capsys.readouterr().err


def test_several_studies_run_one_process_after_the_other(tmp_path, capsys):
    assert run.main(["sphere", "sphere", "--size", "small", "--moved", "300", "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "[1/2] sphere: done, " in text
    assert "[2/2] sphere: done, " in text
    assert json.loads((tmp_path / "sphere.json").read_text())["config"]["moved"] == 300


def test_a_failure_is_reported_and_does_not_stop_the_other_studies(tmp_path, capsys, monkeypatch):
    outcomes = {"gradient": "failed with status 2", "robustness": "data absent"}
    calls = []

    def run_one(name, arguments, environment):
        calls.append((name, *arguments))
        write_results(tmp_path, name, lines=[{"value": 1}])
        return outcomes.get(name, "")

    monkeypatch.setattr(run_all, "_run", run_one)
    assert run.main(["all", "--size", "small", "--out", str(tmp_path)]) == 1
    assert calls == [(name, "--size", "small", "--out", str(tmp_path)) for name in STUDIES]
    assert capsys.readouterr().out.splitlines()[-2:] == ["robustness: data absent", "gradient: failed with status 2"]
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert "| 1 |" in section(text, "sphere")
    assert "## gradient" not in text
    assert "`robustness` (data absent), `gradient` (failed with status 2)" in text


def test_absent_data_is_not_a_failure(monkeypatch):
    monkeypatch.setattr(run_all, "_run", lambda *_: "data absent")
    assert run.main(["sphere", "gradient"]) == 0


@pytest.mark.parametrize(("status", "outcome"), [(0, ""), (1, "failed with status 1"), (NOT_MEASURED, "data absent")])
def test_the_exit_status_gives_the_outcome_of_a_study(monkeypatch, status, outcome):
    finished = type("Finished", (), {"returncode": status})
    monkeypatch.setattr(run_all.subprocess, "run", lambda *_, **__: finished)
    assert run_all._run("sphere", [], {}) == outcome


def test_the_page_of_the_kept_results_stands_beside_their_folder(tmp_path, monkeypatch):
    out = tmp_path / "out"
    monkeypatch.setattr(run, "RESULTS", out)
    assert run.write_page(out, {}) == tmp_path / "README.md"
    assert run.write_page(tmp_path, {}) == tmp_path / "README.md"


def test_the_page_in_the_repository_is_up_to_date(tmp_path):
    kept = (PROJECT / "experiments" / "README.md").read_text(encoding="utf-8")
    assert kept == run.page(RESULTS, RESULTS.parent, {})
