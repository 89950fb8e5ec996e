"""Head, sections and style of a page, and figures in its text."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from html import escape
from importlib import resources

from matplotlib.figure import Figure

from erlif.plots.style import ONE_COLUMN, figure_bytes
from erlif.report.captions import Caption

_MEDIA = {"svg": "image/svg+xml", "png": "image/png"}


def compose_page(
    sections: Sequence[tuple[str, str, str]],
    *,
    name: str,
    subject: str,
    subtitle: str,
    after: str = "",
) -> str:
    """Compose a page that needs no other file.

    Parameters
    ----------
    sections : sequence of (str, str, str)
        Identifier, title and content, HTML, of each section.
    name : str
        Heading, plain text.
    subject : str
        What the page is about, for the title of the window.
    subtitle : str
        Line below the heading, plain text.
    after : str
        Scripts behind the sections, HTML; empty or ending with a new line.

    Returns
    -------
    str
    """
    contents = "".join(f'<li><a href="#{key}">{title}</a></li>' for key, title, _ in sections)
    body = "\n".join(
        f'<section id="{key}" aria-labelledby="{key}-title"><h2 id="{key}-title">{title}</h2>\n'
        f"{content}\n</section>"
        for key, title, content in sections
    )
    name = escape(name)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="generator" content="erlif">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{name}: {subject}</title>
<style>
{read_resource("page.css")}</style>
</head>
<body>
<header>
<h1>{name}</h1>
<p class="quiet">{escape(subtitle)}</p>
<nav aria-label="Contents"><ul>{contents}</ul></nav>
</header>
<main>
{body}
</main>
{after}</body>
</html>
"""


def read_resource(name: str) -> str:
    """A file of this folder: style or script of a page."""
    return resources.files("erlif.report").joinpath(name).read_text(encoding="utf-8")


def embed_figure(name: str, figure: Figure, caption: Caption, text: str) -> str:
    """Embed one figure, its image as base64 text."""
    # lines stay sharp as SVG; an image of many pixels is much smaller as PNG
    image = figure_bytes(figure, kind=caption.kind, dpi=caption.dpi)
    encoded = base64.b64encode(image).decode("ascii")
    width = "two" if figure.get_figwidth() > 1.5 * ONE_COLUMN else "one"
    title, text = escape(caption.title), escape(text)
    return (
        f'<figure id="figure-{name}" class="{width}">'
        f'<img src="data:{_MEDIA[caption.kind]};base64,{encoded}" alt="{title}. {text}">'
        f"<figcaption><strong>{title}.</strong> {text}</figcaption></figure>"
    )
