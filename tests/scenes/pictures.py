"""Figures compared with stored pictures, without texts.

``pytest tests/show/plots/FILE --mpl-generate-path=tests/show/plots/baseline`` draws the pictures
of a file again; look at each before it is stored.
"""

from __future__ import annotations

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from erlif.show.plots.style import AnyFigure, fix_layout

TOLERANCE = 1.5
"""Rms of the differences of two pictures; curves that are 2 % higher give 4.3 and more."""

picture = pytest.mark.mpl_image_compare(
    baseline_dir="baseline",
    tolerance=TOLERANCE,
    savefig_kwargs={"dpi": 60},
    style="default",
    deterministic=True,
)


def without_texts(figure: AnyFigure) -> Figure:
    """The figure in its layout, then without texts, whose pixels differ between machines."""
    whole = fix_layout(figure)
    for text in whole.findobj(Text):
        text.set_alpha(0.0)
    for ax in whole.findobj(lambda artist: hasattr(artist, "tick_params")):
        ax.tick_params(which="both", labelcolor="none")  # of ticks that are made later as well
    return whole


def labels_of(ax: Axes) -> list[str]:
    """Texts of the legend of axes."""
    return [text.get_text() for text in ax.get_legend().get_texts()]
