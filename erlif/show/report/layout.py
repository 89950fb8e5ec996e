"""Head, sections and style of a page, and figures in its text."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape
from importlib import resources
from itertools import groupby
from typing import NamedTuple

from erlif.show.plots.style import ONE_COLUMN, AnyFigure, figure_bytes
from erlif.show.report.captions import Caption

_MEDIA = {"svg": "image/svg+xml", "png": "image/png"}
_LARGE = 400_000  # bytes of a drawing that is kept as an image of pixels


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
    return resources.files("erlif.show.report").joinpath(name).read_text(encoding="utf-8")


class PageFigure(NamedTuple):
    """A figure as a page holds it.

    Attributes
    ----------
    name : str
        Name within the page.
    image : str
        HTML of the image.
    caption : str
        HTML of the caption.
    wide : bool
        Whether it is two columns wide.
    """

    name: str
    image: str
    caption: str
    wide: bool


def embed_figure(name: str, figure: AnyFigure, caption: Caption, text: str) -> PageFigure:
    """Embed one figure, its image as base64 text."""
    # lines stay sharp as SVG; an image of many pixels, or many points, is much smaller as PNG
    kind = caption.kind
    image = figure_bytes(figure, kind=kind, dpi=caption.dpi)
    if kind == "svg" and len(image) > _LARGE:
        kind = "png"
        image = figure_bytes(figure, kind=kind, dpi=caption.dpi)
    encoded = base64.b64encode(image).decode("ascii")
    title, text = escape(caption.title), escape(text)
    return PageFigure(
        name,
        f'<img src="data:{_MEDIA[kind]};base64,{encoded}" alt="{title}. {text}">',
        f"<figcaption><strong>{title}.</strong> {text}</figcaption>",
        figure.bbox.width > 1.5 * ONE_COLUMN * figure.dpi,
    )


def arrange_figures(figures: Iterable[PageFigure]) -> str:
    """Arrange figures in two columns, in their order.

    A wide one takes both columns. A narrow one without a partner takes them too, with its caption
    beside it, so that no half of a row is empty.

    Parameters
    ----------
    figures : iterable of PageFigure

    Returns
    -------
    str
        HTML; empty without figures.
    """
    parts = []
    for wide, run in groupby(figures, key=lambda figure: figure.wide):
        members = list(run)
        for n, figure in enumerate(members):
            lone = len(members) % 2 == 1 and n == len(members) - 1
            kind = "two" if wide else "one lone" if lone else "one"
            parts.append(
                f'<figure id="figure-{figure.name}" class="{kind}">'
                f'<div class="wide">{figure.image}</div>{figure.caption}</figure>'
            )
    return '<div class="figures">\n' + "\n".join(parts) + "\n</div>" if parts else ""
