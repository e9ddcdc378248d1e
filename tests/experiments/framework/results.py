"""Writes result files like those of a study, for the tests of the page."""

import json

from experiments.framework.tables import markdown


def write_results(out, name, *, lines, config=None, models=None, figures=()):
    """Writes result files like those of a study."""
    about = {
        "command": f"python -m experiments.run {name} --size small",
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
    (out / f"{name}.md").write_text(markdown(lines))
    for suffix in figures:
        (out / f"{name}{suffix}").write_bytes(b"picture")


def section(page, name):
    """The section of a study."""
    return page.split(f"\n## {name}\n")[1].split("\n## ")[0]
