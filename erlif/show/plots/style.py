"""The look of the figures, and their files.

Colours of lines after Okabe and Ito (2008), of images after Crameri (2018).
"""

from __future__ import annotations

import functools
import inspect
import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple, ParamSpec, TypeVar

import cmap
import matplotlib
import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap
from matplotlib.container import Container
from matplotlib.figure import Figure, SubFigure
from matplotlib.image import AxesImage
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.lines import Line2D
from matplotlib.ticker import Locator, LogLocator, MaxNLocator, NullFormatter

from erlif.core.arrays import Array, Image
from erlif.core.errors import OutputError
from erlif.core.flags import FLAG_COLOURS as FLAG_COLOURS
from erlif.io.files import PRODUCTS, takes, write_file
from erlif.show.plots.naming import name_film


def _read_sheet(name: str) -> dict[str, Any]:
    """Settings of a style sheet beside this module."""
    sheet = Path(__file__).with_name(f"{name}.mplstyle")
    settings: Any = matplotlib.rc_params_from_file(sheet, use_default_template=False)
    return dict(settings)


# Widths of a journal's columns. [inch]
ONE_COLUMN, TWO_COLUMNS = 90 / 25.4, 190 / 25.4

# Colours for colour-blind readers after Okabe and Ito; markers and dashes differ too, for print
# in grey.
OUTWARD, RETURN, MEAN, MINIMUM, MUTED = "#0072B2", "#D55E00", "#009E73", "#000000", "#6B6B6B"

# Colour of pixels without a value.
FLAGGED = "#D9D9D9"

# Hatch of such pixels in a map of differences, where white and pale colours are small differences.
_HATCH: dict[str, Any] = {"facecolor": FLAGGED, "edgecolor": "#8C8C8C", "hatch": 6 * "/"}

# Looks of the strokes: filled circles for rising encoder angle, open squares for falling.
STROKES: dict[int, dict[str, Any]] = {
    1: {"label": "outward", "color": OUTWARD, "marker": "o", "markerfacecolor": OUTWARD},
    -1: {"label": "return", "color": RETURN, "marker": "s", "markerfacecolor": "white"},
}

# Height by width of two panels one above the other, so that such figures stand side by side.
STACK = 1.15

# Bars, bands and ellipses of all figures are one standard deviation; this is how keys name it.
ONE_STD = "1 s.d."

_TEXT = 7.0  # point; size of text that the lengths below belong to

# lengths in points beside such text, which follow its size, and the rest of the look
_LENGTHS, _PLAIN = _read_sheet("lengths"), _read_sheet("look")

# what no style changes: no layout engine but that of the figure, and a fixed salt, so that the same
# figure gives the same file
_FIXED: dict[str, Any] = {"svg.hashsalt": "erlif", "figure.autolayout": False}
_FIXED["figure.constrained_layout.use"] = False

# Style sheets of erlif; matplotlib finds them as `erlif.show.plots.paper` and so on.
STYLES = ("paper", "slides")

_NO_DATES = dict.fromkeys(("CreationDate", "ModDate", "Producer"))
_METADATA: dict[str, Mapping[str, Any]] = {
    "png": {"Software": "erlif"},
    "pdf": {"Creator": "erlif", **_NO_DATES},
    "svg": {"Creator": "erlif", "Date": None},
}

_LABELS = 4.2  # heights of the text of a legend that the label of the x axis takes above it
_KEYS: dict[str, Any] = {"handleheight": 1.0, "columnspacing": 1.2, "labelspacing": 0.35}

# level 6, the default, takes half as long again for 2 % smaller files
_PNG_COMPRESSION = 4

# default of the axes of a panel: `panel` makes new ones before the function sees them
NEW: Any = None

AnyFigure = Figure | SubFigure
Limits = tuple[float, float] | tuple[None, None]  # None: of the values themselves

P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function to draw in the look of erlif; settings of the caller are kept.

    What the caller has set, by a style sheet or by itself, is kept. Text in axes of the caller has
    the size of their labels.
    """

    draw = takes(**PRODUCTS)(draw)

    @functools.wraps(draw)
    def drawing(*args: P.args, **kwargs: P.kwargs) -> R:
        given = kwargs.get("ax")
        with matplotlib.rc_context(_look(given if isinstance(given, Axes) else None)):
            drawn = draw(*args, **kwargs)
            interactive = matplotlib.is_interactive()

        # the first figure of a notebook loads its backend, whose choice must outlast this call
        matplotlib.interactive(interactive)
        return drawn

    return drawing


def panel(draw: Callable[P, R], *, of_film: bool = False) -> Callable[P, R]:
    """Decorate a function of one panel as `styled`; without ``ax`` it has those of a new figure.

    A panel of a film has a figure that names it: the first argument, and what is made of it. The
    figure is closed where the function refuses to draw.
    """
    first = next(iter(inspect.signature(draw).parameters))

    @styled
    @functools.wraps(draw)
    def drawing(*args: P.args, **kwargs: P.kwargs) -> R:
        if kwargs.get("ax") is not None:
            return draw(*args, **kwargs)

        shown: Any = args[0] if args else kwargs.get(first)
        ax = kwargs["ax"] = given_or_new(None, shown if of_film else None)
        try:
            return draw(*args, **kwargs)
        except Exception:
            from matplotlib import pyplot

            pyplot.close(ax.get_figure(root=True))
            raise

    return drawing


def film_panel(draw: Callable[P, R]) -> Callable[P, R]:
    """Decorate a function of one panel whose figure names the film, as `panel`."""
    return panel(draw, of_film=True)


def _look(given: Axes | None = None) -> dict[Any, Any]:
    """Settings of erlif in place of matplotlib's defaults. Lengths follow the size of the text."""
    now: Any = matplotlib.rcParams
    default: Any = matplotlib.rcParamsDefault
    chosen = now["font.size"] != default["font.size"]
    scale = now["font.size"] / _TEXT if chosen else 1.0
    if given is not None and not chosen:
        scale = float(given.xaxis.label.get_fontsize()) / _TEXT
    wanted = _PLAIN | {name: scale * length for name, length in _LENGTHS.items()}
    return {name: to for name, to in wanted.items() if now[name] == default[name]} | _FIXED


@contextmanager
def in_style(style: str | Path | None) -> Iterator[None]:
    """Draw in a style: ``"paper"``, ``"slides"``, the path of a sheet, or None for that of erlif.

    Settings of the caller are put aside, so that the same film gives the same files.
    """
    from matplotlib import style as sheets

    if style is not None and str(style) not in STYLES and not Path(style).is_file():
        raise OutputError(
            f"Expected one of the styles {', '.join(STYLES)} or a file; got {style}. Give the path "
            "of a style sheet of matplotlib (.mplstyle)."
        )
    named = f"erlif.show.plots.{style}" if str(style) in STYLES else style

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.interactive(False)
        if named is not None:
            sheets.use(named)
        yield


def pt(length: float) -> float:
    """Scale a length that suits text of 7 points to the text of the style. [any unit]"""
    return float(length * matplotlib.rcParams["font.size"] / _TEXT)


def is_page() -> bool:
    """Whether the style has one page for every figure, as slides have, and no columns."""
    return bool(matplotlib.rcParams["figure.figsize"][0] > TWO_COLUMNS)


class Picture(Figure):
    """A figure that keeps the look it was made in, and shows itself in a notebook."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        names = [*_PLAIN, *_LENGTHS, *_FIXED]
        now: Any = matplotlib.rcParams
        self._look: dict[Any, Any] = {name: now[name] for name in names}

    def draw(self, renderer: RendererBase) -> None:
        """Draw in the look of the figure: ticks are made only now."""
        with matplotlib.rc_context(self._look):
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        content = io.BytesIO()
        self.savefig(content, format="png", dpi=self.get_dpi())
        return content.getvalue()


@functools.cache
def colour_map(name: str, *, bad: str | None = None) -> Colormap:
    """Load a perceptually uniform colour map of Crameri (2018); `bad` is the colour of NaN."""
    colours: Colormap = cmap.Colormap(f"crameri:{name}").to_mpl()
    return colours if bad is None else colours.with_extremes(bad=bad)


@styled
def new_figure(
    width: float = ONE_COLUMN,
    height: float = 0.72 * ONE_COLUMN,
    *,
    text: float = 0.0,
    given: AnyFigure | None = None,
    named: xr.Dataset | None = None,
    more: str = "",
) -> AnyFigure:
    """Make an empty figure whose panels and labels do not overlap, or take the given one.

    Sizes in inches. Of the height, `text` is lines of text; it follows the size of the text, the
    rest the width of a column of the style. A style for slides has one size for every figure. The
    figure names the film `named`, and `more` that its panels share.
    """
    figure = Picture(**_figure_options(width, height, text)) if given is None else given
    if named is not None:
        name_film(figure, named, more)
    return figure


def _figure_options(width: float, height: float, text: float) -> dict[str, Any]:
    column, page = matplotlib.rcParams["figure.figsize"]
    scale = column / ONE_COLUMN
    size = (column, page) if is_page() else (scale * width, scale * (height - text) + pt(text))
    engine = ConstrainedLayoutEngine(w_pad=pt(0.03), h_pad=pt(0.03), wspace=0.03)
    return {"figsize": size, "layout": engine}


@styled
def given_or_new(
    given: Axes | None,
    named: xr.Dataset | None = None,
    *,
    height: float = 0.72 * ONE_COLUMN,
    text: float = 0.0,
) -> Axes:
    """Take the given axes, or those of a new figure of this height [inch] that names the film.

    The figure is one of pyplot, so that a notebook shows it.
    """
    if given is not None:
        return given
    from matplotlib import pyplot

    figure = pyplot.figure(FigureClass=Picture, **_figure_options(ONE_COLUMN, height, text))
    if named is not None:
        name_film(figure, named)
    return figure.add_subplot()


def rows_or_columns(
    figure: Figure | SubFigure, count: int, *, sharex: bool = False, ratios: Sequence[float] = ()
) -> list[Axes]:
    """Make panels one below the other, or side by side on a page."""
    if is_page():
        return list(figure.subplots(1, count, squeeze=False).ravel())
    grid = figure.subplots(count, 1, squeeze=False, sharex=sharex, height_ratios=ratios or None)
    return list(grid.ravel())


def draw_image(
    ax: Axes,
    values: npt.ArrayLike,
    limits: Limits,
    *,
    colours: str = "batlow",
    bad: str | None = FLAGGED,
    extent: tuple[float, float, float, float] | None = None,
) -> AxesImage:
    """Draw an image as it was measured, without interpolation; `bad` is the colour of NaN."""
    look: dict[str, Any] = {"cmap": colour_map(colours, bad=bad), "extent": extent}
    look |= dict(zip(("vmin", "vmax"), limits, strict=True))
    image = ax.imshow(values, interpolation="none", **look)
    for side in ("top", "right"):  # the edge of an image is data
        ax.spines[side].set_visible(True)
    return image


def draw_line(
    ax: Axes,
    x: npt.ArrayLike,
    y: npt.ArrayLike,
    colour: str,
    *,
    form: Any = None,
    width: float | None = None,
    size: float | None = None,
    **look: Any,
) -> list[Line2D]:
    """Draw a line or points of one colour.

    `form` is a form of matplotlib, as ``"--"`` or ``"o"``, or dashes; `width` and `size` of the
    markers are in points beside text of 7 points; `look` as for `matplotlib.axes.Axes.plot`.
    """
    lengths = {"linewidth": width, "markersize": size}
    look |= {name: pt(length) for name, length in lengths.items() if length is not None}
    if isinstance(form, str):
        return ax.plot(x, y, form, color=colour, **look)
    return ax.plot(x, y, linestyle=form, color=colour, **look)


class Curve(NamedTuple):
    """A line or points of one colour.

    Attributes
    ----------
    x, y : array
        Places, in the units of the axes.
    colour : str
        As in `draw_line`.
    label : str or None
        Its name in the legend.
    look : mapping
        What `draw_line` takes besides.
    """

    x: npt.ArrayLike
    y: npt.ArrayLike
    colour: str
    label: str | None = None
    look: Mapping[str, Any] = {}


def draw_curves(ax: Axes, curves: Iterable[Curve], x: str, y: str, **options: Any) -> list[Any]:
    """Draw the curves of one quantity, label its axes, and name above them what has a label.

    Options are those of `matplotlib.axes.Axes.set`. Returns the lines.
    """
    lines = [
        line
        for one in curves
        for line in draw_line(ax, one.x, one.y, one.colour, label=one.label, **one.look)
    ]
    ax.set(xlabel=x, ylabel=y, **options)
    plain_log_ticks(ax)
    if ax.get_legend_handles_labels()[1]:
        legend_above(ax)
    return lines


def draw_band(
    ax: Axes,
    x: Array,
    low: Array,
    high: Array,
    colour: str,
    *,
    label: str | None = None,
    **look: Any,
) -> Artist:
    """Fill the band between two curves, pale and without an edge."""
    look = {"alpha": 0.3, "linewidth": 0} | look
    return ax.fill_between(x, low, high, color=colour, label=label, **look)


def write_beside(
    ax: Axes, text: str, point: tuple[float, float], offset: tuple[float, float], **options: Any
) -> None:
    """Write a text beside a point of the data, at a distance in points."""
    ax.annotate(text, point, xytext=offset, textcoords="offset points", **options)


def even_limits(difference: Array | Image, *, within: float, least: float) -> tuple[float, float]:
    """Ends of a colour scale with zero in its middle, for `within` per cent of the sizes."""
    known = np.abs(difference[np.isfinite(difference)])
    reach = max(float(np.percentile(known, within)) if known.size else 0.0, least)
    return -reach, reach


def add_colour_bar(
    image: ScalarMappable, ax: Axes, label: str, *, extend: str = "both"
) -> Colorbar:
    """Add a colour bar of the height of the image; a label longer than the figure is broken."""
    beside = ax.inset_axes((1.025, 0.0, 0.04, 1.0))
    bar = figure_of(ax).colorbar(image, cax=beside, extend=extend, extendfrac=0.03)
    bar.set_label(label, wrap=True)
    return bar


def legend_above(ax: Axes, *, ncols: int | None = None, title: str = "") -> None:
    """Add a legend above the axes, where it covers no point; in two columns, or one on a page."""
    ncols = ncols or (1 if is_page() else 2)
    place: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0)}
    place |= {"borderaxespad": 0.2, "columnspacing": 1.0, "handletextpad": 0.5}
    ax.legend(**_named(ax), ncols=ncols, title=title, **place)


def legend_below(ax: Axes, *, ncols: int = 2, title: str = "") -> None:
    """Add a legend below the label of the x axis."""
    place: dict[str, Any] = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.0)}
    place["borderaxespad"] = _LABELS
    ax.legend(**_named(ax), ncols=ncols, title=title, **_KEYS, **place)


def legend_of_figure(figure: AnyFigure, *, ncols: int = 2, title: str = "") -> None:
    """Put one legend below all panels in place of theirs."""
    for ax in figure.axes:
        if (own := ax.get_legend()) is not None:
            own.remove()
    if (keys := _named(*figure.axes))["labels"]:
        place: dict[str, Any] = {"loc": "outside lower center", "ncols": ncols, "title": title}
        figure.legend(**keys, **place, **_KEYS)


def _named(*panels: Axes) -> dict[str, Any]:
    """What has a label in panels, points before lines; a label is named once."""
    found: dict[str, Any] = {}
    for ax in panels:
        for key, label in zip(*ax.get_legend_handles_labels(), strict=True):
            found.setdefault(label, key)
    labels = sorted(found, key=lambda label: not isinstance(found[label], Container))
    return {"handles": [found[label] for label in labels], "labels": labels}


def add_key(ax: Axes, label: str, **look: Any) -> None:
    """Name an area of one look in the legend."""
    ax.fill_between([], [], label=label, **look)


def hatch_missing(ax: Axes, label: str = "") -> None:
    """Hatch what an image leaves transparent, where it has no value; a label is for the legend."""
    ax.patch.set(**_HATCH, linewidth=0)
    if label:
        add_key(ax, label, **_HATCH, linewidth=0)


def state_empty(ax: Axes, text: str) -> None:
    """Write in the middle of empty axes why they are empty."""
    box = {"facecolor": "white", "edgecolor": MUTED, "linewidth": pt(0.5)}
    middle: dict[str, Any] = {"transform": ax.transAxes, "ha": "center", "va": "center"}
    ax.text(0.5, 0.5, text, zorder=6, bbox=box, **middle)


def is_visible(ax: Axes, width: Array, line: float) -> bool:
    """Whether a band of this width [units of the y axis] is wider than a line [point]."""
    known = width[np.isfinite(width)]
    if known.size == 0:
        return False
    low, high = ax.get_ylim()
    height = 72 * ax.get_window_extent().height / figure_of(ax).dpi
    return bool(np.median(known) / abs(high - low) * height > line)


def letter(ax: Axes, text: str) -> None:
    """Mark a panel as (a) at its upper left: before its title, else beside a legend above it."""
    title = ax.get_title().replace("$", r"\$")  # the letter alone is mathematics, in bold
    ax.set_title("")
    drawn = rf"$\mathbf{{({text})}}$ {title}".rstrip()
    ax.set_title(drawn, loc="left", ha="left" if title else "right")


_FEWEST_TICKS = 3  # with a number, on a logarithmic axis


def plain_log_ticks(ax: Axes) -> None:
    """Write the ticks of logarithmic axes as plain numbers, close enough for a short range."""
    for axis in (ax.xaxis, ax.yaxis):
        if axis.get_scale() == "log":
            low, high = axis.get_view_interval()
            # the shorter the axis, the more ticks a decade needs
            decades = np.log10(high / low)
            steps = range(1, 9) if decades < 0.7 else (1, 2, 3, 5) if decades < 1.5 else (1, 2, 5)
            places: Locator = LogLocator(subs=[*steps], numticks=20)
            shown = [low < at < high for at in places.tick_values(low, high)]
            if sum(shown) < _FEWEST_TICKS:
                places = LogLocator(
                    subs=[*np.arange(1, 2, 0.1), *np.arange(2, 10, 0.5)], numticks=20
                )
                if sum(low < at < high for at in places.tick_values(low, high)) < _FEWEST_TICKS:
                    places = MaxNLocator(_FEWEST_TICKS)
            axis.set_major_locator(places)
            axis.set_minor_locator(LogLocator(subs=[*range(1, 10)], numticks=20))
            axis.set_major_formatter("{x:g}")
            axis.set_minor_formatter(NullFormatter())


def letter_panels(*panels: Axes) -> None:
    """Mark panels as (a), (b), ... in their order; an axis that two share is named below alone."""
    for ax, text in zip(panels, "abcdefgh", strict=False):
        letter(ax, text)
    for ax, below in pairwise(panels):
        if ax.get_shared_x_axes().joined(ax, below):
            ax.set_xlabel("")


def draw_panels(panels: Iterable[Axes], drawings: Iterable[Callable[..., Any]], shown: Any) -> None:
    """Draw one product in several ways, each in its panel, and mark the panels."""
    for ax, draw in zip(panels, drawings, strict=True):
        draw(shown, ax=ax)
    letter_panels(*panels)


def figure_of(drawn: Artist) -> Figure | SubFigure:
    """Return the figure of axes or of what is drawn on them."""
    figure = drawn.get_figure()
    assert figure is not None
    return figure


def save_figure(figure: AnyFigure, path: Path, *, dpi: float | None = None) -> Path:
    """Write a figure as PNG, PDF or SVG by the suffix of `path`.

    The same figure gives the same bytes.

    Parameters
    ----------
    figure : Figure
        From a function of this stage, or any other.
    path : Path
        The file; an existing one is replaced in one step.
    dpi : float, optional
        Pixels per inch of a PNG, and of images in a PDF or SVG; default: that of the style, which
        is 300 without one.

    Returns
    -------
    Path
        `path`, so that calls can be nested.

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
    return write_file(path, content)


def figure_bytes(figure: AnyFigure, *, kind: str, dpi: float | None = None) -> bytes:
    """Return the content of a file of kind ``"png"``, ``"pdf"`` or ``"svg"``.

    The layout of the figure is fixed by this call.
    """
    whole = figure.get_figure(root=True)
    assert whole is not None
    with matplotlib.rc_context(whole._look if isinstance(whole, Picture) else _look()):
        own = whole.get_dpi()
        dpi = matplotlib.rcParams["savefig.dpi"] if dpi is None else dpi
        whole.set_dpi(min(dpi, own))  # text of few pixels is larger than its size
        fix_layout(whole)
        whole.set_dpi(own)
        options: dict[str, Any] = {"format": kind, "dpi": dpi, "metadata": _METADATA.get(kind)}
        if kind == "png":
            titled = {"Title": title} if (title := whole.get_suptitle()) else {}
            options["metadata"] = {**_METADATA[kind], **titled}
            options["pil_kwargs"] = {"compress_level": _PNG_COMPRESSION}
        content = io.BytesIO()
        whole.savefig(content, **options)
    return content.getvalue()


def fix_layout(figure: AnyFigure) -> Figure:
    """Place the panels of a figure for good; returns the whole figure."""
    whole = figure.get_figure(root=True)
    assert whole is not None
    engine = whole.get_layout_engine()
    if engine is not None:
        # images of fixed aspect change their size in the first round, and their labels with them
        rounds = 2 if any(ax.get_aspect() != "auto" for ax in whole.axes) else 1
        for _ in range(rounds):
            engine.execute(whole)
        # with any engine, even one that does nothing, each file would be drawn twice
        whole.set_layout_engine(None)
    return whole
