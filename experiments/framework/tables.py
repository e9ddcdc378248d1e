"""Rows of results, and their formats: CSV, aligned text and Markdown."""

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import Any

Row = dict[str, Any]
"""Values by column; all rows of a table have the same columns."""


def grouped(rows: Iterable[Row], *keys: str) -> dict[Any, list[Row]]:
    """Groups rows by the value of a column, or by the tuple of values of several columns, in order of appearance."""
    groups: dict[Any, list[Row]] = {}
    for row in rows:
        values = tuple(row[key] for key in keys)
        groups.setdefault(values if len(keys) > 1 else values[0], []).append(row)
    return groups


def write_rows(rows: list[Row], path: Path) -> None:
    """Writes rows as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def text_table(lines: list[Row]) -> str:
    """Formats rows as aligned text."""
    cells = [list(lines[0]), *([_text(value) for value in line.values()] for line in lines)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    return "\n".join("  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)).rstrip() for row in cells)


def markdown(lines: list[Row]) -> str:
    """Formats rows as a Markdown table."""
    cells = [list(lines[0]), ["---"] * len(lines[0]), *([_text(value) for value in line.values()] for line in lines)]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in cells)


def _text(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.3g}" if abs(value) < 1e4 else f"{value:.3e}"
    return str(value)
