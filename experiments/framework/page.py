"""The page of the studies, from what they wrote: the same files give the same page."""

import json
import os
from collections.abc import Mapping
from pathlib import Path

from experiments.framework.catalogue import STUDIES, load
from experiments.framework.options import PROGRAM
from experiments.framework.study import Study
from experiments.framework.tables import Row, markdown

PREAMBLE = """# Experiments

This page is written by `python -m experiments.run all` from the files of the studies; change those and not this page.

Each study prints a table, with the paper's number or the target beside ours where there is one. It writes its rows as
CSV, the table as Markdown, the figure, if it has one, as PNG and PDF, and how they came about (command, commit,
versions, seed, machine, time) as JSON into `experiments/out`, or `experiments/out/small` at the small size; tables,
figures and provenance of the former are kept in the repository. Run them in the checkout, with
`pip install ".[test]"` (or `".[experiments,arena]"`):

```sh
python -m experiments.run list
python -m experiments.run planted               # full size
python -m experiments.run planted --size small  # seconds
python -m experiments.run planted --help
python -m experiments.run all --size small      # all of them, and a page of their results beside them
python -m experiments.run page                  # this page again
```

**Data.** The paper's benchmark (1 354 clouds of Funk et al. 2017) is not used here unless a section says so: what runs
on objects that symjax generates has no number that is comparable with the paper's table by table. Studies that take
real models too do so by `--data FOLDER` with a `planes.json` (`{"name": {"file": …, "normal": […] or null, "offset": …
or null, "kind": …}}`) and the files that it names; by default they look for `../shared/data` beside the checkout. Where
they are absent the studies say so and run without them.

**Protocol.** Points are sampled at random from the surface, posed first (random rotation or reflection, shift), then
corrupted: a box of outliers along the object's own axes would be symmetric itself. "Right" is a normal within 5° and an
offset within 2 % of the diagonal, and `found`, unless a section says otherwise."""


def page(out: Path, folder: Path, missing: Mapping[str, str]) -> str:
    """The page as Markdown.

    Args:
        out: where the studies left their files.
        folder: where the page will stand, to which links to figures are relative.
        missing: studies that have no section, whatever lies in `out`, and why.
    """
    written = [name for name in STUDIES if name not in missing and _is_there(out, name)]
    absent = {name: missing.get(name, "not run") for name in STUDIES if name not in written}
    studies = {name: load(name) for name in written}
    listed = [
        {"command": f"`{PROGRAM} {name}`", "what it shows": study.title, "in the paper": study.paper}
        for name, study in studies.items()
    ]
    parts = [PREAMBLE]
    if listed:
        parts.append(markdown(listed))
    if absent:
        parts.append("**Without a section here:** " + ", ".join(f"`{n}` ({why})" for n, why in absent.items()) + ".")
    links = Path(os.path.relpath(out, folder)).as_posix()
    return "\n\n".join([*parts, *(_section(study, out, links) for study in studies.values())]) + "\n"


def _is_there(out: Path, name: str) -> bool:
    return all((out / f"{name}{suffix}").is_file() for suffix in (".json", ".md"))


def _section(study: Study, out: Path, links: str) -> str:
    name = study.name
    about = json.loads((out / f"{name}.json").read_text(encoding="utf-8"))
    parts = [f"## {name}", study.title, study.text, f"```sh\n{about['command']}\n```", _data(study, about)]
    parts.append(_table(name, out))
    png, pdf = f"{name}.png", f"{name}.pdf"
    if (out / png).is_file():
        also = f" ([PDF]({links}/{pdf}))" if (out / pdf).is_file() else ""
        parts.append(f"![{study.title}]({links}/{png}){also}")
    return "\n\n".join(part for part in [*parts, _provenance(about)] if part)


def _table(name: str, out: Path) -> str:
    """The table, with the sentences that the study wrote under it."""
    return (out / f"{name}.md").read_text(encoding="utf-8").strip()


def _data(study: Study, about: Row) -> str:
    """What it says of its data, and of how many models of every group its rows are."""
    text = f"Data: {study.data}."
    groups = about["models"]
    if groups:
        text += " Models: " + "; ".join(f"{count} {group}" for group, count in groups.items()) + "."
    config = about["config"]
    asked = config.get("data") or "real" in config.get("benchmark", "")
    if asked and groups and all(group.startswith(("generated", "procedural")) for group in groups):
        text += " THE REAL MODELS WERE ABSENT."
    return text


def _provenance(about: Row) -> str:
    config, machine = about["config"], about["machine"]
    seed = next(
        (f"{field} {config[field]}" for field in ("seed", "seeds") if field in config), "seeds fixed in the study"
    )
    versions = ", ".join(f"{package} {version}" for package, version in about["versions"].items())
    return (
        f"Size {about['size']}; {seed}; {about['wall_seconds']:.0f} s, begun {about['started']}; "
        f"{machine['cpu']}, {machine['cores']} cores, {machine['system']}; {versions}; "
        f"commit {about['commit'] or 'unknown'}."
    )
