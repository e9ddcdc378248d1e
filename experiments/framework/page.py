"""Writes the page of all studies from their result files; the same files give the same page."""

import json
import os
from collections.abc import Mapping
from pathlib import Path

from experiments.framework.catalogue import STUDIES, load
from experiments.framework.options import PROGRAM
from experiments.framework.study import Study
from experiments.framework.tables import Row, markdown

PREAMBLE = """# Experiments

This page is written by `python -m experiments.run all` from the result files of the studies: edit the studies, not this
page.

Every study prints a table, with the paper's number or the target beside ours if there is one. It writes its rows as
CSV, the table as Markdown, the figure, if it has one, as PNG and PDF, and the provenance (command, commit, versions,
seed, machine, time) as JSON. The files go to `experiments/out`, or to `experiments/out/small` at the small size. Of
the former, the tables, figures and provenance are kept in the repository. Run the studies in the checkout, after
`pip install ".[arena]"` (or `".[test]"`, which lacks pyclarcs only):

```sh
python -m experiments.run list                  # all studies and what they show
python -m experiments.run planted               # one study, at full size
python -m experiments.run planted --size small  # the same in seconds
python -m experiments.run planted --help        # its options
python -m experiments.run all --size small      # all studies, and a page of their small results
python -m experiments.run page                  # this page, from the results that exist
```

**Data.** The paper's benchmark (1 354 clouds of Funk et al. 2017) is not used unless a section says so. Most studies
run on objects that symjax generates; their numbers cannot be compared with the paper's, table by table. Some studies
also take real models, by `--data FOLDER`. The folder holds a `planes.json` (`{"name": {"file": …, "normal": […] or
null, "offset": … or null, "kind": …}}`) and the files that it names; the default is `../shared/data` beside the
checkout. If the real models are absent, these studies say so and run without them.

**Protocol.** Points are sampled at random from the surface. The cloud is posed first (random rotation or reflection,
and shift) and then corrupted, because a box of outliers along the object's own axes would itself be symmetric. Unless a
section says otherwise, a detection is "correct" if it is `found`, its normal is within 5° of the true one, and its
offset is within 2 % of the diagonal.

**Labels.** Some labels and columns of the tables were renamed after the runs, so that they agree with the present code;
the numbers were not changed. The figures were drawn by the runs and may show former labels."""


def page(out: Path, folder: Path, missing: Mapping[str, str]) -> str:
    """Returns the page as Markdown.

    Args:
        out: folder of the result files.
        folder: folder of the page; links to figures are relative to it.
        missing: reasons why studies have no results, by name; these studies get no section, even if `out` holds files
            of an earlier run.
    """
    written = [name for name in STUDIES if name not in missing and _has_results(out, name)]
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


def _has_results(out: Path, name: str) -> bool:
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
    """Returns the table, with the notes of the study under it."""
    return (out / f"{name}.md").read_text(encoding="utf-8").strip()


def _data(study: Study, about: Row) -> str:
    """Returns the line about the data: its description, and the number of models of every group."""
    text = f"Data: {study.data}."
    groups = about["models"]
    if groups:
        text += " Models: " + "; ".join(f"{count} {group}" for group, count in groups.items()) + "."
    config = about["config"]
    wants_real = config.get("data") or "real" in config.get("benchmark", "")
    if wants_real and groups and all(group.startswith(("generated", "procedural")) for group in groups):
        text += " THE REAL MODELS WERE ABSENT."
    return text


def _provenance(about: Row) -> str:
    config, machine = about["config"], about["machine"]
    seed = next(
        (f"{field} {config[field]}" for field in ("seed", "seeds") if field in config), "seeds fixed in the study"
    )
    versions = ", ".join(f"{package} {version}" for package, version in about["versions"].items())
    commit = about["commit"] or "unknown"
    doubts = []
    if about["size"] == "small":
        doubts.append("**This is a small run**, which only shows that the study works.")
    if not about["commit"] or commit.endswith("+"):
        doubts.append("**The code was not committed when this ran.**")
    provenance = (
        f"Size {about['size']}; {seed}; {about['wall_seconds']:.0f} s, started {about['started']}; "
        f"{machine['cpu']}, {machine['cores']} cores, {machine['system']}; {versions}; "
        f"commit {commit}."
    )
    return " ".join([*doubts, provenance])
