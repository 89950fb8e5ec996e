"""The look of the figures, and their files.

Colours of lines after Okabe and Ito (2008), of images after Crameri (2018).
"""

from __future__ import annotations

import functools
import io
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import cmap
import matplotlib
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap
from matplotlib.figure import Figure, SubFigure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from erlif.core.flags import FLAG_COLOURS as FLAG_COLOURS
from erlif.files import replacing

ONE_COLUMN, TWO_COLUMNS = 90 / 25.4, 190 / 25.4
"""Widths of a journal's columns. [inch]"""

OUTWARD, RETURN, MEAN, MINIMUM, MUTED = "#0072B2", "#D55E00", "#009E73", "#000000", "#6B6B6B"
"""Colours for colour-blind readers after Okabe and Ito; markers and dashes differ too, for print
in grey."""

FLAGGED = "#D9D9D9"
"""Colour of pixels without a value."""

STROKES: dict[int, dict[str, Any]] = {
    1: {"label": "outward", "color": OUTWARD, "marker": "o", "markerfacecolor": OUTWARD},
    -1: {"label": "return", "color": RETURN, "marker": "s", "markerfacecolor": "white"},
}
"""Looks of the strokes: filled circles for rising encoder angle, open squares for falling."""

COVERAGE = 1.96
"""Standard deviations on either side of a 95 % band."""

_STYLE: Any = {
    "font.family": "DejaVu Sans",  # part of matplotlib, so the same on every machine
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
    # no layout engine but the one of the figure
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
}

# the same figure gives the same file on every day and machine
_METADATA: dict[str, Mapping[str, Any]] = {
    "png": {"Software": "erlif"},
    "pdf": {"CreationDate": None, "ModDate": None, "Producer": None, "Creator": "erlif"},
    "svg": {"Date": None, "Creator": "erlif"},
}

# level 6, the default, takes half as long again for 2 % smaller files
_PNG_COMPRESSION = 4

# tables for setting new text; a PDF places each glyph itself, and subsetting them takes longer
# than the rest of a font
_TEXT_LAYOUT = ("GDEF", "GPOS", "GSUB", "kern")

P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Let a function draw in the style of erlif without a change to the settings of the caller."""

    @functools.wraps(draw)
    def drawing(*args: P.args, **kwargs: P.kwargs) -> R:
        with matplotlib.rc_context(_STYLE):
            return draw(*args, **kwargs)

    return drawing


def colour_map(name: str, *, bad: str | None = None) -> Colormap:
    """Load a perceptually uniform colour map of Crameri (2018); `bad` is the colour of NaN."""
    colours = _crameri(name)
    return colours.with_extremes(bad=bad) if bad is not None else colours.copy()


@functools.cache
def _crameri(name: str) -> Colormap:
    """The colour map as matplotlib reads it; a sheet of maps asks for one fifty times."""
    colours: Colormap = cmap.Colormap(f"crameri:{name}").to_mpl()
    return colours


def new_figure(width: float = ONE_COLUMN, height: float = 0.72 * ONE_COLUMN) -> Figure:
    """Make an empty figure whose panels and labels do not overlap. Sizes in inches."""
    return Figure(
        figsize=(width, height), layout=ConstrainedLayoutEngine(w_pad=0.03, h_pad=0.03, wspace=0.03)
    )


def given_or_new(ax: Axes | None, *, height: float = 0.72 * ONE_COLUMN) -> Axes:
    """Take the given axes, or those of a new figure of this height [inch]."""
    return new_figure(height=height).add_subplot() if ax is None else ax


def add_colour_bar(image: ScalarMappable, ax: Axes, label: str, *, extend: str = "both") -> None:
    """Add a colour bar of the height of the image."""
    beside = ax.inset_axes((1.025, 0.0, 0.04, 1.0))
    figure_of(ax).colorbar(image, cax=beside, label=label, extend=extend, extendfrac=0.03)


def frame_legend(ax: Axes, **options: Any) -> None:
    """Add a legend on white, so that no line crosses its text."""
    legend = ax.legend(frameon=True, facecolor="white", edgecolor="none", framealpha=1.0, **options)
    legend.set_zorder(5)


def signed(value: float, digits: int = 2) -> str:
    """Write a number with its sign, and a minus of the width of a plus."""
    return f"{value:+.{digits}f}".replace("-", "−")


def letter(ax: Axes, text: str) -> None:
    """Mark a panel as (a), (b), ... at its upper left."""
    ax.set_title(f"({text})", loc="left", fontweight="bold")


def figure_of(ax: Axes) -> Figure | SubFigure:
    """Return the figure of an axes."""
    figure = ax.get_figure()
    assert figure is not None
    return figure


def save_figure(figure: Figure, path: Path, *, dpi: float = 300.0) -> Path:
    """Write a figure as PNG, PDF or SVG by the suffix of `path`.

    The same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
        From a function of this stage, or any other.
    path : Path
        The file; an existing one is replaced in one step.
    dpi : float
        Pixels per inch of a PNG, and of images in a PDF or SVG.

    Returns
    -------
    Path
        `path`.

    Raises
    ------
    OutputError
        If it cannot be written; an existing file is then unchanged.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> figure = new_figure()
    >>> panel = figure.add_subplot()
    >>> with TemporaryDirectory() as directory:
    ...     path = save_figure(figure, Path(directory) / "panel.png")
    ...     path.read_bytes()[1:4]
    b'PNG'
    """
    content = figure_bytes(figure, kind=path.suffix.removeprefix("."), dpi=dpi)
    with replacing(path) as scratch:
        scratch.write_bytes(content)
    return path


@styled
def figure_bytes(figure: Figure, *, kind: str, dpi: float = 300.0) -> bytes:
    """Return the content of a file of kind ``"png"``, ``"pdf"`` or ``"svg"``.

    The layout of the figure is fixed by this call.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        # images of fixed aspect change their size in the first round, and their labels with them
        rounds = 2 if any(ax.get_aspect() != "auto" for ax in figure.axes) else 1
        for _ in range(rounds):
            engine.execute(figure)
        # with any engine, even one that does nothing, each file would be drawn twice
        figure.set_layout_engine(None)

    options: dict[str, Any] = {"format": kind, "dpi": dpi, "metadata": _METADATA.get(kind)}
    if kind == "png":
        options["pil_kwargs"] = {"compress_level": _PNG_COMPRESSION}
    content = io.BytesIO()
    with _without_text_layout():
        figure.savefig(content, **options)
    return content.getvalue()


@contextmanager
def _without_text_layout() -> Iterator[None]:
    """Embed fonts without the tables for setting new text."""
    from fontTools.subset import Options  # type: ignore[import-untyped]

    # matplotlib takes fontTools' defaults and has no setting for them; without this list
    # fontTools embeds all tables, which takes longer
    dropped = getattr(Options, "_drop_tables_default", None)
    if dropped is None:
        yield
        return

    Options._drop_tables_default = [*dropped, *_TEXT_LAYOUT]
    try:
        yield
    finally:
        Options._drop_tables_default = dropped
