"""Writes `architecture.svg`, and the last column of the tables of `architecture.md`: `python docs/architecture.py`.

The packages and their order are read from the import contracts in `pyproject.toml`. What this file adds is where each
box stands and which data goes from one package to another.
"""

import re
import tomllib
from html import escape
from pathlib import Path
from typing import NamedTuple

PROJECT = Path(__file__).resolve().parents[1]
PICTURE = Path(__file__).with_suffix(".svg")
PAGE = Path(__file__).with_suffix(".md")

WIDTH, TOP, ROW, BOX = 1080, 56, 78, 46
"""Width of the picture, top of the first layer, height of a layer, and height of a box."""


class Box(NamedTuple):
    """A package: where it begins and ends, and what it does, in a few words."""

    left: int
    right: int
    role: str


class Flow(NamedTuple):
    """Data that goes from one package to another, straight up or down.

    Attributes:
        source: package that makes the data.
        target: package that takes it. Names joined by "|" are several packages of one layer that take the same.
        x: place of the arrow.
        data: what it is.
    """

    source: str
    target: str
    x: int
    data: str


class Panel(NamedTuple):
    """The layers of one top-level package.

    Attributes:
        package: name of the top-level package.
        title: heading.
        left: where its layers begin.
        right: where they end.
        boxes: its packages by name.
        flows: the data between them.
    """

    package: str
    title: str
    left: int
    right: int
    boxes: dict[str, Box]
    flows: list[Flow]


SYMJAX = Panel(
    "symjax",
    "symjax: data goes up, imports go down",
    20,
    720,
    {
        "cli": Box(110, 700, "the command `symjax`: files in, answer and pictures out"),
        "scale_sweep": Box(110, 230, "fits for many σ"),
        "detection": Box(250, 700, "`detect`: runs a method, answers in the units of the points"),
        "robust": Box(250, 355, "default method"),
        "symhks": Box(365, 470, "paper's method"),
        "method": Box(480, 560, "the Protocol"),
        "preprocess": Box(330, 470, "points to cloud"),
        "l2e": Box(110, 310, "the estimator, in JAX"),
        "viz": Box(490, 580, "page, picture"),
        "datasets": Box(600, 700, "known planes"),
        "io": Box(110, 700, "reads files strictly, writes them atomically"),
        "geometry": Box(110, 700, "planes, similarities, distances, uncertainties"),
        "errors": Box(110, 700, "what can be raised"),
    },
    [
        Flow("io", "l2e", 200, "pairs"),
        Flow("io", "preprocess", 420, "points"),
        Flow("l2e", "scale_sweep", 170, "Fit, all σ and starts"),
        Flow("scale_sweep", "cli", 170, "optima, page"),
        Flow("l2e", "robust|symhks", 280, "Fit"),
        Flow("preprocess", "robust|symhks", 420, "Cloud"),
        Flow("robust|symhks", "detection", 360, "MethodResult"),
        Flow("detection", "cli", 475, "Detection"),
        Flow("detection", "viz", 575, "Detection"),
        Flow("datasets", "detection", 650, "points"),
    ],
)
EXPERIMENTS = Panel(
    "experiments",
    "experiments: imports symjax",
    760,
    1060,
    {
        "run": Box(780, 1040, "the command"),
        "studies": Box(780, 1040, "one question each"),
        "comparison": Box(780, 1040, "all methods on corrupted objects"),
        "baselines": Box(845, 945, "other methods"),
        "metrics": Box(845, 1040, "how good a plane is"),
        "data": Box(780, 900, "known planes"),
        "execution": Box(920, 1040, "resumable tasks"),
        "framework": Box(780, 1040, "what all studies share"),
    },
    [
        Flow("data", "comparison", 810, "Case"),
        Flow("baselines", "comparison", 870, "Detection"),
        Flow("metrics", "comparison", 975, "scores"),
        Flow("comparison", "studies", 910, "rows"),
        Flow("studies", "run", 910, "table, figure"),
    ],
)
PANELS = [SYMJAX, EXPERIMENTS]

STYLE = """
text { font-family: system-ui, "Segoe UI", "DejaVu Sans", sans-serif; fill: #1b1f24 }
.title { font-size: 17px; font-weight: 600 }
.name { font-size: 14px; font-weight: 600; text-anchor: middle }
.role { font-size: 11.5px; text-anchor: middle; fill: #424a53 }
.data { font-size: 12px; font-style: italic; fill: #0550ae }
.note { font-size: 12.5px; fill: #424a53 }
.page { fill: #ffffff }
.layer { fill: #eef1f4 }
.box { fill: #ffffff; stroke: #8c959f }
.alike { fill: none; stroke: #8c959f; stroke-dasharray: 4 3 }
.flow { stroke: #0969da; stroke-width: 1.8; fill: none }
.head { fill: #0969da }
@media (prefers-color-scheme: dark) {
text { fill: #e6edf3 }
.role, .note { fill: #b1bac4 }
.data { fill: #79c0ff }
.page { fill: #0d1117 }
.layer { fill: #1c232c }
.box { fill: #0d1117; stroke: #6e7681 }
.alike { stroke: #6e7681 }
.flow { stroke: #58a6ff }
.head { fill: #58a6ff }
}
"""

NOTES = [
    "Arrows: data, from the package that makes it to the one that takes it.",
    "A package imports packages of lower layers only, and none of its own layer.",
]


def layers_of(package: str) -> list[list[str]]:
    """The layers of a top-level package, the highest first, as its import contract lists them."""
    settings = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    (layers,) = (c["layers"] for c in contracts if c["type"] == "layers" and c["containers"] == [package])
    return [[name.strip() for name in layer.split("|")] for layer in layers]


def with_imports(page: str) -> str:
    """The page with the packages that each package may import: those of lower layers."""
    for panel in PANELS:
        layers = layers_of(panel.package)
        before, heading, section = page.partition(f"\n## {panel.package}\n")
        section, *after = re.split(r"(?=\n## )", section, maxsplit=1)
        for row, layer in enumerate(layers):
            lower = ", ".join(f"`{name}`" for names in layers[row + 1 :] for name in names) or "–"
            for name in layer:
                section = re.sub(rf"^(\| `{name}` \|.*\|)[^|]*\|$", rf"\1 {lower} |", section, flags=re.MULTILINE)
        page = "".join([before, heading, section, *after])
    return page


def picture() -> str:
    """The picture as SVG.

    Raises:
        ValueError: a package of the contracts has no box, or a box no package.
    """
    parts = [part for panel in PANELS for part in _drawn(panel)]
    bottom = TOP + ROW * max(len(layers_of(panel.package)) for panel in PANELS)
    height = bottom + 16 + 20 * len(NOTES)
    notes = [_text(20, bottom + 20 + 20 * row, "note", note) for row, note in enumerate(NOTES)]
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img">',
            "<title>The packages of symjax in layers, and the data that goes between them</title>",
            f"<style>{STYLE}</style>",
            f'<rect class="page" width="{WIDTH}" height="{height}" rx="8"/>',
            *parts,
            *notes,
            "</svg>\n",
        ]
    )


def _drawn(panel: Panel) -> list[str]:
    layers = layers_of(panel.package)
    named = {name for layer in layers for name in layer}
    if named != set(panel.boxes):
        raise ValueError(f"docs/architecture.py and the contracts differ: {sorted(named ^ set(panel.boxes))}")
    row_of = {name: row for row, layer in enumerate(layers) for name in layer}
    parts = [_text(panel.left, TOP - 20, "title", panel.title)]
    for row in range(len(layers)):
        top, width = TOP + ROW * row, panel.right - panel.left
        parts.append(f'<rect class="layer" x="{panel.left}" y="{top}" width="{width}" height="{BOX + 12}" rx="6"/>')
    for name, box in panel.boxes.items():
        top, middle = TOP + ROW * row_of[name] + 6, (box.left + box.right) / 2
        size = f'width="{box.right - box.left}" height="{BOX}"'
        parts.append(f'<rect class="box" x="{box.left}" y="{top}" {size} rx="5"/>')
        parts.append(_text(middle, top + 19, "name", name))
        parts.append(_text(middle, top + 36, "role", box.role.replace("`", "")))
    for several in sorted({name for flow in panel.flows for name in flow[:2] if "|" in name}):
        parts += _frame([panel.boxes[name] for name in several.split("|")], TOP + ROW * row_of[several.split("|")[0]])
    if panel is SYMJAX:
        parts += _file(TOP + ROW * row_of["io"] + 6 + BOX / 2, panel)
    return parts + [part for flow in panel.flows for part in _arrow(flow, row_of)]


def _frame(boxes: list[Box], top: float) -> list[str]:
    left, right = min(box.left for box in boxes) - 6, max(box.right for box in boxes) + 6
    return [f'<rect class="alike" x="{left}" y="{top}" width="{right - left}" height="{BOX + 12}" rx="6"/>']


def _file(y: float, panel: Panel) -> list[str]:
    """The file that all begins with, to the left of the package that reads it."""
    return [_text(panel.left + 12, y - 8, "data", "a file"), *_line(panel.left + 8, y, panel.boxes["io"].left, y)]


def _arrow(flow: Flow, row_of: dict[str, int]) -> list[str]:
    source, target = (TOP + ROW * row_of[name.split("|")[0]] + 6 for name in (flow.source, flow.target))
    # where several packages share an arrow, it ends at the frame around them
    source, target = source - 6 * ("|" in flow.source), target + 6 * ("|" in flow.target)
    start, end = (source, target + BOX) if source > target else (source + BOX, target)
    # beside the end of the arrow: the other one may be rows away
    label = end + 21 if source > target else end - 12
    return [*_line(flow.x, start, flow.x, end), _text(flow.x + 8, label, "data", flow.data)]


def _line(x: float, y: float, to_x: float, to_y: float) -> list[str]:
    along = ((to_x > x) - (to_x < x), (to_y > y) - (to_y < y))
    across = (-along[1], along[0])
    corners = [
        (to_x - 8 * along[0] + side * 4.5 * across[0], to_y - 8 * along[1] + side * 4.5 * across[1]) for side in (1, -1)
    ]
    head = " ".join(f"{a:g},{b:g}" for a, b in [(to_x, to_y), *corners])
    end = f'x2="{to_x - 6 * along[0]:g}" y2="{to_y - 6 * along[1]:g}"'
    return [
        f'<line class="flow" x1="{x:g}" y1="{y:g}" {end}/>',
        f'<polygon class="head" points="{head}"/>',
    ]


def _text(x: float, y: float, kind: str, text: str) -> str:
    return f'<text class="{kind}" x="{x:g}" y="{y:g}">{escape(text)}</text>'


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8", newline="\n")
    PAGE.write_text(with_imports(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
