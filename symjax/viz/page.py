"""Writes plotly figures as self-contained pages that load nothing from the network."""

import os
from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING, Any

from symjax.io.atomic import replacing
from symjax.viz.colours import FAINT_INK, css

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

DIV_ID = "symjax-figure"

FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', Arial, sans-serif"

POLICY = "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:"
"""Content security policy: the browser refuses to load anything. Plotly compiles drawing code, so it needs eval."""

PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{policy}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>
html, body {{ height: 100%; margin: 0; background: #fff; }}
body {{ display: flex; flex-direction: column; font: 14px {font}; color: {faint}; }}
main {{ flex: 1; min-height: 420px; }}
footer {{ padding: 4px 24px 14px; }}
</style>
</head>
<body>
<main>
{figure}
</main>
<footer>{notes}</footer>
</body>
</html>
"""


def write_page(
    figure: "Figure",
    path: str | os.PathLike[str],
    *,
    title: str,
    notes: Iterable[str],
    buttons: list[str] | None = None,
    script: str | None = None,
) -> None:
    """Writes a figure as one file of about 5 MB, which contains plotly's script.

    Args:
        figure: figure to show.
        path: file to write; an existing file is replaced.
        title: title of the page, as plain text.
        notes: sentences below the figure, as plain text.
        buttons: plotly's names of the buttons above the figure; by default there are none.
        script: JavaScript to run after the figure is drawn; `{plot_id}` stands for the figure's id.

    Raises:
        InvalidArgumentError: if the file cannot be written.
    """
    bar: dict[str, Any] = {"modeBarButtons": [buttons]} if buttons else {"displayModeBar": False}
    body = figure.to_html(
        full_html=False,
        include_plotlyjs=True,
        include_mathjax=False,
        div_id=DIV_ID,
        default_height="100%",
        auto_play=False,
        post_script=script,
        config={"displaylogo": False, "responsive": True, "plotlyServerURL": "", **bar},
    )
    text = PAGE.format(
        title=escape(title),
        policy=POLICY,
        font=FONT,
        faint=css(FAINT_INK),
        figure=body,
        notes=" · ".join(escape(str(note)) for note in notes),
    )
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
