"""The figures of the report, embedded in the page."""

from __future__ import annotations

import base64
from html import escape

from matplotlib.figure import Figure

from erlif.files import describe_trigger
from erlif.plots.files import DRAWN, FigureSource, reason_missing
from erlif.plots.style import ONE_COLUMN, figure_bytes
from erlif.report.captions import Caption, caption_of

_MEDIA = {"svg": "image/svg+xml", "png": "image/png"}
_OF_ONE_TRIGGER = ("processed_images", "ratio_image", "thickness_map")


def figures_section(source: FigureSource) -> str:
    """Draw all figures of a film as HTML, and list those that are left out with the reason."""
    parts, missing = [], []
    for name, draw in DRAWN.items():
        caption = caption_of(name, source.film)
        reason = reason_missing(name, source)
        if reason is not None:
            missing.append(f"<li>{caption.title}: {escape(reason)}</li>")
            continue

        text = caption.text
        if name in _OF_ONE_TRIGGER:
            text = f"{describe_trigger(source.film, source.trigger).capitalize()}. {text}"
        parts.append(_embed(name, draw(source), caption, text))

    left_out = f"<h3>Left out</h3><ul>{''.join(missing)}</ul>" if missing else ""
    return '<div class="figures">\n' + "\n".join(parts) + "\n</div>" + left_out


def _embed(name: str, figure: Figure, caption: Caption, text: str) -> str:
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
