"""The file of results survives a killed writer, and has one writer at a time."""

import pytest

from experiments.execution import run
from experiments.execution.store import Store
from tests.experiments.execution.processes import here


def test_a_file_cut_anywhere_in_its_last_line_loses_only_that_line(tmp_path):
    path = tmp_path / "lines.jsonl"
    items = [{"a": 1}, {"b": "é\n", "c": [None, 0.1]}]
    with Store(path) as store:
        for item in items:
            store.append(item)
    whole = path.read_bytes()
    first = whole.index(b"\n") + 1
    for cut in range(len(whole) + 1):
        path.write_bytes(whole[:cut])
        kept = items[: (cut >= first - 1) + (cut >= len(whole) - 1)]
        with Store(path) as store:
            assert store.items == kept
            store.append({"new": cut})
        with Store(path) as store:
            assert store.items == [*kept, {"new": cut}]
    path.write_bytes(whole[:first] + b"\0\0\0")
    with Store(path) as store:
        assert store.items == items[:1]


def test_a_file_of_another_format_is_refused_unchanged(tmp_path):
    path = tmp_path / "lines.jsonl"
    path.write_text('{"a": 1}\nsome text\n{"a": 2}\n')
    with pytest.raises(ValueError, match="line 2 is not a JSON object"):
        Store(path)
    assert path.read_text().count("\n") == 3
    path.write_text('{"a": 1}\n')
    with pytest.raises(ValueError, match="not a result"):
        run([{"k": 1}], here("drawn"), path)


def test_a_file_has_one_writer(tmp_path):
    with Store(tmp_path / "lines.jsonl"), pytest.raises(RuntimeError, match="another process"):
        Store(tmp_path / "lines.jsonl")
    with Store(tmp_path / "lines.jsonl") as store:
        assert store.items == []
