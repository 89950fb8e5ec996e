"""The figures of the report, embedded in the page."""

from __future__ import annotations

from html import escape

from erlif.core.progress import Progress, silent
from erlif.io.files import describe_trigger
from erlif.show.plots.files import DRAWN, FigureSource, reason_missing
from erlif.show.plots.style import in_style
from erlif.show.report.captions import caption_of
from erlif.show.report.layout import arrange_figures, embed_figure

_OF_ONE_TRIGGER = ("processed_images", "ratio_image", "thickness_map", "prediction_map")


def figures_section(
    source: FigureSource, progress: Progress = silent, *, room: float = float("inf")
) -> str:
    """Draw all figures of a film as HTML, and list those that are left out with the reason.

    The largest are left out until the rest has at most `room` characters.
    """
    parts, missing = [], []
    for done, (name, draw) in enumerate(DRAWN.items()):
        progress("figures", done, len(DRAWN))
        caption = caption_of(name, source.film)
        reason = reason_missing(name, source)
        if reason is not None:
            missing.append(f"<li>{caption.title}: {escape(reason)}</li>")
            continue

        text = caption.text
        if name in _OF_ONE_TRIGGER:
            text = f"{describe_trigger(source.film, source.trigger).capitalize()}. {text}"
        with in_style(None):
            parts.append(embed_figure(name, draw(source), caption, text))

    progress("figures", len(DRAWN), len(DRAWN))
    while sum(len(one.image) for one in parts) > room:
        largest = max(parts, key=lambda one: len(one.image))
        parts.remove(largest)
        title = caption_of(largest.name, source.film).title
        missing.append(
            f"<li>{title}: too large for this page; <code>erlif figures</code> draws it, "
            "<code>--max-size</code> allows a larger page</li>"
        )
    left_out = f"<h3>Left out</h3><ul>{''.join(missing)}</ul>" if missing else ""
    return arrange_figures(parts) + left_out
