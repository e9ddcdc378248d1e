"""Error messages have one form: what must hold, and then what was passed."""

import re
from pathlib import Path

import symjax

PACKAGE = Path(symjax.__file__).parent


def test_the_value_that_was_passed_follows_the_word_got():
    other_forms = re.compile(r"\bmust (be|have)\b.*, (not|but got|was) \{")
    found = [
        f"{path.relative_to(PACKAGE)}:{number}: {line.strip()}"
        for path in sorted(PACKAGE.rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if other_forms.search(line)
    ]
    assert found == []
