"""The look of the figures, and their files.

Colours of lines after Okabe and Ito (2008), of images after Crameri (2018).
"""

from __future__ import annotations

import functools
import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Any, ParamSpec, TypeVar

import cmap
import matplotlib
import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axes._base import _AxesBase
from matplotlib.axis import Axis
from matplotlib.backend_bases import RendererBase
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import Colormap
from matplotlib.figure import Figure, SubFigure
from matplotlib.gridspec import SubplotSpec
from matplotlib.image import AxesImage
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter
from matplotlib.transforms import Bbox, ScaledTranslation

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

_PANEL = 17.0  # width of the letter of a panel, with a gap [point]
_BROKEN = 0.6  # part of a long label that its first line takes
_ACROSS = 0.92  # width of laid out axes over the one before
_TITLE = 0.95  # part of its place that a title may take
_NARROWEST = 0.3  # part of its place that an image keeps beside colour bar and legend
_LETTER, _BESIDE = 3.9, 0.3  # width of a letter [point], room at both ends of a colour bar [inch]
_SHORTEST = 12  # letters of a short label

_LINE, _LAID_OUT = 9.0, 0.85  # height of a line [point], and of laid out axes over the one before
_KEYS: dict[str, Any] = {"handlelength": 1.8, "handleheight": 1.0, "columnspacing": 1.2}

# level 6, the default, takes half as long again for 2 % smaller files
_PNG_COMPRESSION = 4

AnyFigure = Figure | SubFigure

P = ParamSpec("P")
R = TypeVar("R")


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Let a function draw in the look of erlif without a change to the settings of the caller.

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

    kept: dict[Any, Any] = {
        name: value for name, value in matplotlib.rcParamsDefault.items() if name != "backend"
    }
    with matplotlib.rc_context():
        matplotlib.rcParams.update(kept)
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


def colour_map(name: str, *, bad: str | None = None) -> Colormap:
    """Load a perceptually uniform colour map of Crameri (2018); `bad` is the colour of NaN."""
    colours = _crameri(name)
    return colours.with_extremes(bad=bad) if bad is not None else colours.copy()


@functools.cache
def _crameri(name: str) -> Colormap:
    """The colour map as matplotlib reads it; a sheet of maps asks for one fifty times."""
    colours: Colormap = cmap.Colormap(f"crameri:{name}").to_mpl()
    return colours


@styled
def new_figure(
    width: float = ONE_COLUMN, height: float = 0.72 * ONE_COLUMN, *, text: float = 0.0
) -> Picture:
    """Make an empty figure whose panels and labels do not overlap. Sizes in inches.

    Of the height, `text` is lines of text; it follows the size of the text, the rest the width of a
    column of the style. A style for slides has one size for every figure.
    """
    return Picture(**_figure_options(width, height, text))


def given_figure(
    given: AnyFigure | None,
    width: float = ONE_COLUMN,
    height: float = 0.72 * ONE_COLUMN,
    *,
    text: float = 0.0,
    film: xr.Dataset | None = None,
    more: str = "",
) -> AnyFigure:
    """Take the given figure, or a new one; it names the film, and `more` that its panels share."""
    figure = new_figure(width, height, text=text) if given is None else given
    if film is not None:
        name_film(figure, film, more)
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
    limits: tuple[float, float],
    *,
    colours: str = "batlow",
    bad: str | None = FLAGGED,
    extent: tuple[float, float, float, float] | None = None,
) -> AxesImage:
    """Draw an image as it was measured, without interpolation; `bad` is the colour of NaN."""
    look: dict[str, Any] = {"cmap": colour_map(colours, bad=bad), "extent": extent}
    look |= dict(zip(("vmin", "vmax"), limits, strict=True))
    image = ax.imshow(values, interpolation="none", **look)
    close_frame(ax)
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


def write_inside(ax: Axes, text: str, place: tuple[float, float], **options: Any) -> None:
    """Write a small text in axes, at a place relative to them."""
    ax.annotate(text, place, xycoords="axes fraction", fontsize=pt(6.5), **options)


def write_beside(
    ax: Axes, text: str, point: tuple[float, float], offset: tuple[float, float], **options: Any
) -> None:
    """Write a text beside a point of the data, at a distance in points."""
    ax.annotate(text, point, xytext=offset, textcoords="offset points", **options)


def close_frame(ax: Axes) -> None:
    """Draw all four sides of the frame, because the edge of an image is data."""
    for side in ("top", "right"):
        ax.spines[side].set_visible(True)


def even_limits(difference: Array | Image, *, within: float, least: float) -> tuple[float, float]:
    """Ends of a colour scale with zero in its middle, for `within` per cent of the sizes."""
    known = np.abs(difference[np.isfinite(difference)])
    reach = max(float(np.percentile(known, within)) if known.size else 0.0, least)
    return -reach, reach


def add_colour_bar(
    image: ScalarMappable, ax: Axes, label: str, *, extend: str = "both"
) -> Colorbar:
    """Add a colour bar of the height of the image."""
    beside = ax.inset_axes((1.025, 0.0, 0.04, 1.0))
    bar = figure_of(ax).colorbar(image, cax=beside, extend=extend, extendfrac=0.03)
    bar.set_label(label)
    ax.apply_aspect()
    _wrap_label(bar, ax)
    return bar


def _wrap_label(bar: Colorbar, ax: Axes) -> None:
    """Break the label of a colour bar that is longer than the bar; it would leave the figure."""
    height = ax.get_position().height * figure_of(ax).bbox.height / figure_of(ax).dpi  # inch
    letters = max(int(72 * (_LAID_OUT * height + pt(_BESIDE)) / pt(_LETTER)), _SHORTEST)
    lines = str(bar.ax.get_ylabel()).split("\n")
    bar.set_label("\n".join(part for line in lines for part in wrap(line, letters)))


def frame_legend(ax: Axes, *, ncols: int = 1, **options: Any) -> None:
    """Add a legend on white, so that no line crosses its text, in columns that the axes hold."""
    look: dict[str, Any] = {"facecolor": "white", "edgecolor": "none", "framealpha": 1.0}
    look |= {"frameon": True, "alignment": "left"}
    room = _ACROSS * ax.get_window_extent().width
    legend = _fit_columns(ax, room, ncols=ncols, **look, **options)
    legend.set_zorder(5)


def legend_above(ax: Axes, **options: Any) -> None:
    """Add a legend above the axes, where it covers no point and not the letter of the panel."""
    options = {"ncols": 3, "columnspacing": 1.0, "handletextpad": 0.5} | options
    options |= {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.2}
    room = _ACROSS * ax.get_window_extent().width - pt(_PANEL) * figure_of(ax).dpi / 72
    _fit_columns(ax, room, **options)


def legend_below(ax: Axes, handles: Sequence[Artist], **options: Any) -> None:
    """Add a legend below the label of the x axis, in two columns or in what its place is wide."""
    figure = figure_of(ax)
    ax.apply_aspect()
    labels = ax.xaxis.get_tightbbox()
    below = 0.0 if labels is None else (ax.bbox.y0 - labels.y0) / figure.dpi
    down = ScaledTranslation(0.0, -below, figure.dpi_scale_trans)
    place = {"bbox_to_anchor": (0.5, 0.0), "bbox_transform": ax.transAxes + down}
    options = _KEYS | place | {"loc": "upper center", "labelspacing": 0.35} | options
    _fit_columns(ax, _place_of(ax), handles=handles, ncols=2, **options)


def legend_of_figure(figure: AnyFigure, handles: Sequence[Artist]) -> None:
    """Add one legend below all panels, in as many columns as the figure is wide."""
    for columns in range(len(handles), 0, -1):
        place: dict[str, Any] = {"loc": "outside lower center", "ncols": columns}
        legend = figure.legend(handles=handles, **place, **_KEYS)
        if columns == 1 or legend.get_window_extent().width <= _TITLE * figure.bbox.width:
            return
        legend.remove()


def swatch(colour: str, label: str) -> Patch:
    """Key of an area of one colour."""
    return Patch(facecolor=colour, edgecolor="#404040", linewidth=pt(0.4), label=label)


def hatch_missing(ax: Axes, label: str = "not valid") -> Patch:
    """Hatch what an image leaves transparent, where it has no value; returns the key."""
    ax.patch.set(**_HATCH, linewidth=0)
    return Patch(**_HATCH, linewidth=0, label=label)


def _fit_columns(ax: Axes, room: float, *, ncols: int, **options: Any) -> Legend:
    """Add a legend of as many columns as a width has room for. [px]"""
    for columns in range(ncols, 0, -1):
        legend = ax.legend(ncols=columns, **options)
        width = legend.get_window_extent().width
        if width <= room:
            return legend

    # still too wide: its labels take two lines
    for text in legend.get_texts():
        letters = int(_BROKEN * len(text.get_text()))
        if text.get_window_extent().width > _BROKEN * width:
            text.set_text("\n".join(wrap(text.get_text(), max(letters, _SHORTEST))))
    return legend


def _place_of(ax: Axes) -> float:
    """Width of the column of a figure in which axes and their labels stand. [px]"""
    spec = ax.get_subplotspec()
    if spec is None:
        return float(ax.bbox.width)
    grid = spec.get_gridspec()
    share = len(spec.colspan) / grid.ncols
    return float(share * figure_of(ax).bbox.width)


def keep_in_place(ax: Axes, bar: Colorbar | None = None) -> None:
    """Shrink axes so that their colour bar and the legend below lie within their place.

    A layout engine does this by itself; a plain figure of matplotlib has none.
    """
    figure = figure_of(ax)
    if _has_engine(figure):
        return

    def beyond() -> tuple[float, float]:
        """Width of the bar beside the image; height of label and legend below it. [inch]"""
        beside, legend = None if bar is None else bar.ax.get_tightbbox(), ax.get_legend()
        right = 0.0 if beside is None else beside.x1 - ax.bbox.x1
        below = 0.0 if legend is None else ax.bbox.y0 - legend.get_window_extent().y0
        return right / figure.dpi, below / figure.dpi

    # the label of a shorter bar may need two lines, which are wider
    ax.apply_aspect()
    ax.set_anchor("N")
    for _ in range(3):
        place = _Place(*beyond(), ax.get_subplotspec())
        ax.set_axes_locator(place)
        ax.apply_aspect(place(ax, None))
        if bar is not None:
            _wrap_label(bar, ax)


@dataclass(frozen=True)
class _Place:
    """Place of an image beside its colour bar and above its legend, in a figure without engine.

    Attributes
    ----------
    right, below : float
        What the bar and the legend take. [inch]
    spec : SubplotSpec or None
        Place of the axes in a grid, which matplotlib's tight layout asks for.
    """

    right: float
    below: float
    spec: SubplotSpec | None

    def __call__(self, ax: _AxesBase, renderer: RendererBase | None) -> Bbox:
        """Box of the image, relative to the figure."""
        figure, place = ax.get_figure(), ax.get_position(original=True)
        assert figure is not None
        if _has_engine(figure):
            return place
        inch = figure.dpi / np.array([figure.bbox.width, figure.bbox.height])
        width = max(place.width - self.right * inch[0], _NARROWEST * place.width)
        height = max(place.height - self.below * inch[1], _NARROWEST * place.height)
        return Bbox.from_bounds(place.x0, place.y1 - height, width, height)

    def get_subplotspec(self) -> SubplotSpec | None:
        """Place of the axes in their grid."""
        return self.spec


def _has_engine(figure: AnyFigure) -> bool:
    """Whether the whole figure has a layout engine."""
    whole = figure.get_figure(root=True)
    return whole is not None and whole.get_layout_engine() is not None


def wrap_title(ax: Axes) -> None:
    """Break a title that is longer than the place of its axes."""
    title = ax.title
    room, width = _TITLE * _place_of(ax), title.get_window_extent().width
    if width > room:
        ax.set_title("\n".join(wrap(title.get_text(), int(len(title.get_text()) * room / width))))


def room_for(ax: Axes, lines: float) -> float:
    """Height of lines of text over the rest of the height of axes, before the layout is known."""
    height, text = _LAID_OUT * _height_of(ax), lines * pt(_LINE)
    return float(text / max(height - text, text))


def _height_of(ax: Axes) -> float:
    """Height of axes. [point]"""
    return 72 * ax.get_window_extent().height / figure_of(ax).dpi


def make_room(ax: Axes, lines: float) -> None:
    """Raise the upper end of an axis by lines of text above what is drawn."""
    low, high = ax.get_ylim()
    ax.set_ylim(low, high + room_for(ax, lines) * (high - low))


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
    return bool(np.median(known) / abs(high - low) * _height_of(ax) > line)


def signed(value: float, digits: int = 2) -> str:
    """Write a number with its sign, and a minus of the width of a plus."""
    return f"{value:+.{digits}f}".replace("-", "−")


def letter(ax: Axes, text: str) -> None:
    """Mark a panel as (a) at its upper left; its title follows where it is long."""
    title = ax.get_title()
    beside = (_ACROSS * ax.get_window_extent().width - ax.title.get_window_extent().width) / 2
    if title and (is_page() or beside < pt(_PANEL) * figure_of(ax).dpi / 72):
        ax.set_title("")
        escaped = title.replace("$", r"\$")  # the letter alone is set as mathematics, in bold
        ax.set_title(rf"$\mathbf{{({text})}}$ {escaped}", loc="left")
    else:
        ax.set_title(f"({text})", loc="left", fontweight="bold")


def plain_log_axis(axis: Axis) -> None:
    """Write the ticks of a logarithmic axis at 1, 2 and 5 as plain numbers."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter(NullFormatter())


def letter_panels(*panels: Axes) -> None:
    """Mark panels as (a), (b), ... in their order."""
    for ax, text in zip(panels, "abcdefgh", strict=False):
        letter(ax, text)


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
    look = whole._look if isinstance(whole, Picture) else _look()
    with matplotlib.rc_context(look):
        return _draw_bytes(whole, kind, dpi)


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


def _draw_bytes(figure: Figure, kind: str, dpi: float | None) -> bytes:
    dpi = matplotlib.rcParams["savefig.dpi"] if dpi is None else dpi
    own = figure.get_dpi()
    figure.set_dpi(min(dpi, own))  # text of few pixels is larger than its size
    fix_layout(figure)
    figure.set_dpi(own)
    options: dict[str, Any] = {"format": kind, "dpi": dpi, "metadata": _METADATA.get(kind)}
    if kind == "png":
        if title := figure.get_suptitle():
            options["metadata"] = {**(options["metadata"] or {}), "Title": title}
        options["pil_kwargs"] = {"compress_level": _PNG_COMPRESSION}
    content = io.BytesIO()
    figure.savefig(content, **options)
    return content.getvalue()
