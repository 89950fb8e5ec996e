"""How the figures look, and how they become files."""

from __future__ import annotations

import functools
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import cmap
import matplotlib
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap
from matplotlib.figure import Figure, SubFigure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from erlif.core.flags import Flag
from erlif.files import replacing

ONE_COLUMN, TWO_COLUMNS = 90 / 25.4, 190 / 25.4
"""Widths of a journal's columns. [inch]"""

OUTWARD, RETURN, MEAN, LEAST, MUTED = "#0072B2", "#D55E00", "#009E73", "#000000", "#6B6B6B"
"""Colours that the colour-blind tell apart, after Okabe and Ito; markers and dashes tell them apart in grey."""

STROKES = {
    1: {"label": "outward", "color": OUTWARD, "marker": "o", "markerfacecolor": OUTWARD},
    -1: {"label": "return", "color": RETURN, "marker": "s", "markerfacecolor": "white"},
}
"""The two strokes: filled circles while the encoder angle rises, open squares while it falls."""

COVERAGE = 1.96
"""Standard deviations on either side of a 95 % band."""

FLAG_COLOURS = {
    Flag.NO_FILM: "#00D5F0",
    Flag.SATURATED: "#FFE600",
    Flag.OUTSIDE_OVERLAP: "#D9D9D9",
    Flag.POOR_REGISTRATION: "#9A9A9A",
    Flag.BAD_PIXEL: "#E4002B",
    Flag.DIM: "#5A5A5A",
    Flag.BELOW_RANGE: "#000000",
    Flag.ABOVE_RANGE: "#FFFFFF",
}
"""Colours that the map of film thickness does not hold. The first that applies to a pixel is shown."""

_STYLE: Any = {
    "font.family": "DejaVu Sans",  # comes with matplotlib: the same everywhere
    "font.size": 7.0,
    "axes.labelsize": 7.0,
    "axes.titlesize": 7.0,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "figure.titlesize": 7.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.unicode_minus": True,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.0,
    "lines.markeredgewidth": 0.7,
    "errorbar.capsize": 1.2,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.borderaxespad": 0.3,
    "hatch.linewidth": 0.5,
    "figure.dpi": 150.0,
    "savefig.dpi": 300.0,
    "savefig.facecolor": "white",
    "pdf.fonttype": 42,
    "svg.fonttype": "path",
    "svg.hashsalt": "erlif",
    "path.simplify": True,
}

# without these, a file would change with the day it was made
_METADATA: dict[str, Mapping[str, Any]] = {
    "png": {"Software": None},
    "pdf": {"CreationDate": None, "ModDate": None, "Producer": None, "Creator": "erlif"},
    "svg": {"Date": None, "Creator": "erlif"},
}

P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Let a function draw in erlif's style, and leave the caller's settings as they were."""

    @functools.wraps(draw)
    def drawing(*args: P.args, **kwargs: P.kwargs) -> R:
        with matplotlib.rc_context(_STYLE):
            return draw(*args, **kwargs)

    return drawing


def colour_map(name: str, *, bad: str | None = None) -> Colormap:
    """A perceptually uniform map of F. Crameri's collection (doi 10.5281/zenodo.1243862)."""
    colours: Colormap = cmap.Colormap(f"crameri:{name}").to_mpl()
    return colours.with_extremes(bad=bad) if bad is not None else colours


def new_figure(width: float = ONE_COLUMN, height: float = 0.72 * ONE_COLUMN) -> Figure:
    """An empty figure whose panels keep out of each other's way. Sizes in inches."""
    return Figure(
        figsize=(width, height), layout=ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.03, wspace=0.03)
    )


def given_or_new(ax: Axes | None, *, height: float = 0.72 * ONE_COLUMN) -> Axes:
    """The axes to draw into. `height` of a new figure in inches."""
    return new_figure(height=height).add_subplot() if ax is None else ax


def add_colour_bar(image: ScalarMappable, ax: Axes, label: str, *, extend: str = "both") -> None:
    """A colour bar exactly as tall as the image beside it."""
    beside = ax.inset_axes((1.025, 0.0, 0.04, 1.0))
    figure_of(ax).colorbar(image, cax=beside, label=label, extend=extend, extendfrac=0.03)


def frame_legend(ax: Axes, **options: Any) -> None:
    """A legend on white, so that lines do not run through its words and light swatches are seen."""
    legend = ax.legend(frameon=True, facecolor="white", edgecolor="none", framealpha=1.0, **options)
    legend.set_zorder(5)


def signed(value: float, digits: int = 2) -> str:
    """A number with its sign, and a minus of proper width."""
    return f"{value:+.{digits}f}".replace("-", "−")


def letter(ax: Axes, text: str) -> None:
    """Name a panel, (a), (b), ..., at its upper left."""
    ax.set_title(f"({text})", loc="left", fontweight="bold")


def figure_of(ax: Axes) -> Figure | SubFigure:
    """The figure that an axes belongs to."""
    figure = ax.get_figure()
    assert figure is not None
    return figure


def save_figure(figure: Figure, path: Path, *, dpi: float = 300.0) -> Path:
    """Write a figure as PNG, PDF or SVG by the suffix of `path`; the same figure gives the same bytes.

    Raises
    ------
    OutputError
        If it cannot be written; a previous file is then as it was.
    """
    content = figure_bytes(figure, kind=path.suffix.removeprefix("."), dpi=dpi)
    with replacing(path) as scratch:
        scratch.write_bytes(content)
    return path


@styled
def figure_bytes(figure: Figure, *, kind: str, dpi: float = 300.0) -> bytes:
    """A figure as a file of kind ``"png"``, ``"pdf"`` or ``"svg"`` would hold it. Its layout is then fixed."""
    engine = figure.get_layout_engine()
    if engine is not None:
        # what keeps its aspect needs a second round to fit its labels in
        for _ in range(2 if any(ax.get_aspect() != "auto" for ax in figure.axes) else 1):
            engine.execute(figure)
        figure.set_layout_engine("none")
    content = io.BytesIO()
    figure.savefig(content, format=kind, dpi=dpi, metadata=_METADATA.get(kind))
    return content.getvalue()
