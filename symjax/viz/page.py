"""A plotly figure as one self-contained page that fetches nothing."""

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
"""The browser itself refuses to fetch anything; plotly compiles its drawing code, hence the eval."""

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
    """Write the figure as one file: plotly's script is inside (about 5 MB).

    Args:
        figure: what the page shows.
        path: file to write; it is replaced if it exists.
        title: the page's title, as plain text.
        notes: sentences below the figure, as plain text.
        buttons: plotly's names of the buttons above the figure; none by default.
        script: run when the figure is drawn; `{plot_id}` in it is the figure's id.

    Raises:
        InvalidArgumentError: the file cannot be written.
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
