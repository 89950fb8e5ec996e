"""Titles and captions of the figures in the report."""

from __future__ import annotations

from dataclasses import dataclass, replace

import xarray as xr

from erlif.core.tables import read_table
from erlif.io.files import settings_of
from erlif.show.plots.triggers import has_varying_speed


@dataclass(frozen=True)
class Caption:
    """Text of a figure, and the format of its image.

    Attributes
    ----------
    title : str
        Heading of the figure.
    text : str
        What the figure shows, panel by panel.
    kind : str
        ``"svg"`` for lines, ``"png"`` for images.
    dpi : float
        Resolution of an image. [pixel/inch]
    """

    title: str
    text: str
    kind: str = "svg"
    dpi: float = 150.0


# Captions by the name of the figure: of `erlif.show.plots.files.DRAWN`, then of other pages.
CAPTIONS = {
    name: Caption(**row) for name, row in read_table("erlif.show.report", "captions.toml").items()
}


def caption_of(name: str, film: xr.Dataset) -> Caption:
    """Choose the caption of a figure by the motion and by what the film holds.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> caption_of("film_over_cycle", example_film()).title
    'Film thickness and speed over the cycle'
    """
    # a caption names what the figure of this film shows, and nothing that it lacks
    caption, settings = CAPTIONS[name], settings_of(film)
    if name == "thickness_map" and settings.joint is None:
        return CAPTIONS["thickness_map_without_joint"]
    if name == "film_against_speed" and "film_theory" not in film:
        text = caption.text.replace("(a) ", "").partition(" (b)")[0]
        return replace(caption, text=text)
    if name == "map_sheet" and settings.mechanism is None:
        return replace(caption, title="Maps of the run")
    if settings.linkage is not None:
        return caption

    # without a linkage there may be neither strokes nor a speed
    if name == "speed_against_angle":
        sliding = CAPTIONS["sliding_speed"]
        text = sliding.text if "stroke" in film else sliding.text.partition(" The points")[0]
        return replace(sliding, text=text)
    if name == "film_over_cycle":
        dotted = " Dotted: the slider turns back." if "position" in film else ""
        if has_varying_speed(film):
            text = caption.text.partition(" Dotted")[0].replace("speed.", "sliding speed.")
            return replace(caption, title="Film thickness and speed", text=text + dotted)
        text = (
            "(a) Minimum and (b) mean film thickness; bands are one standard deviation, random and "
            "shared. The mean is pale where more than 2 % of the region are beyond the measurable "
            "range."
        )
        return replace(caption, title="Film thickness over the run", text=text)
    return caption
