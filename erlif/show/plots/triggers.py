"""Drawing of triggers: abscissa, markers, error bars and lines."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from erlif.core.arrays import Array, Mask
from erlif.io.files import driven_link, flag_shares, motion_of
from erlif.show.plots.naming import describe_shares
from erlif.show.plots.style import ONE_STD, OUTWARD, STROKES, draw_line, is_page, pt, state_empty
from erlif.trend import LARGEST_BEYOND

_STEADY = 0.01  # relative range of a speed that is not drawn: that of a steady disc and its log
_GAP = 1.75  # step over the longer of its neighbours; a trigger left out doubles it

# where there are no strokes
_ONE_WAY = {"label": "trigger", "color": OUTWARD, "marker": "o", "markerfacecolor": OUTWARD}


class Abscissa(NamedTuple):
    """Quantity that the triggers are drawn against.

    Attributes
    ----------
    values : Array
        Its value at each trigger, (trigger,).
    label : str
        Label of the axis, with the unit.
    whole_turn : bool
        Whether it is an angle from 0 to 360 degrees.
    """

    values: Array
    label: str
    whole_turn: bool


def choose_abscissa(film: xr.Dataset) -> Abscissa:
    """Choose the angle of the drive where it is known, else time, encoder angle or trigger.

    A disc that has turned several times is drawn against time, where that is known.
    Arguments as in `erlif.plots`.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> choose_abscissa(example_film()).label
    'crank angle [°]'
    """
    disc = motion_of(film) == "rotation"
    if "crank_angle" in film:
        angle = film.crank_angle.values
        turns = np.count_nonzero(np.diff(angle) < 0)
        if not (disc and turns > 1 and "time" in film):
            return Abscissa(angle, f"{driven_link(film)} angle [°]", True)

    for name, label in (("time", "time [s]"), ("encoder_angle", "encoder angle [°]")):
        if name in film and np.ptp(film[name].values) > 0:
            return Abscissa(film[name].values, label, False)
    return Abscissa(np.arange(film.sizes["trigger"], dtype=float), "trigger", False)


class Bars(NamedTuple):
    """Error bars of the triggers of a film, and the title of their legend.

    Attributes
    ----------
    std : Array
        Standard deviation that is drawn, (trigger,): the random part where it is known. [um]
    title : str
        What the bars are, with the median of the part that all triggers share.
    """

    std: Array
    title: str


def bars_of(film: xr.Dataset, name: str = "film_min") -> Bars:
    """Choose the bars by which the triggers of one film can be compared.

    Parameters
    ----------
    film : xarray.Dataset
        As in `erlif.plots`.
    name : str
        "film_min" or "film_mean".

    Returns
    -------
    Bars

    Examples
    --------
    >>> film = xr.Dataset({
    ...     "film_min_std": ("trigger", [0.5, 0.5]), "film_min_std_random": ("trigger", [0.3, 0.3])
    ... })
    >>> bars_of(film)
    Bars(std=array([0.3, 0.3]), title='bars: 1 s.d., random part; all share ± 0.4 µm')
    """
    whole, title = film[f"{name}_std"].values, f"bars: {ONE_STD}"
    if f"{name}_std_random" not in film:
        return Bars(whole, title)
    random = film[f"{name}_std_random"].values
    shared = np.sqrt(np.maximum(whole**2 - random**2, 0.0))
    if not np.isfinite(shared).any():
        return Bars(random, title)
    return Bars(random, f"{title}, random part; all share ± {np.nanmedian(shared):.2g} µm")


def limit_to_turn(ax: Axes) -> None:
    """Set the limits of an axis of angles to one turn."""
    ax.set_xlim(0, 360)
    ax.set_xticks(range(0, 361, 120 if is_page() else 60))


def label_abscissa(ax: Axes, along: Abscissa) -> None:
    """Label the axis of a quantity, with its limits and ticks where these are known."""
    if along.whole_turn:
        limit_to_turn(ax)
    elif along.label == "trigger":
        ax.xaxis.set_major_locator(MaxNLocator(integer=True))
    ax.set_xlabel(along.label)


def stroke_looks(film: xr.Dataset) -> list[tuple[Mask, dict[str, Any]]]:
    """Triggers of each stroke with the look of their markers; all alike where there is no stroke.

    Examples
    --------
    >>> film = xr.Dataset({"stroke": ("trigger", [1, -1, -1])})
    >>> [(mask.sum().item(), look["label"]) for mask, look in stroke_looks(film)]
    [(1, 'outward'), (2, 'return')]
    """
    if "stroke" not in film:
        return [(np.ones(film.sizes["trigger"], bool), _ONE_WAY)]
    strokes = film.stroke.values
    # a stroke without a trigger has no marker in the legend
    masks = [(np.asarray(strokes == sign), look) for sign, look in STROKES.items()]
    return [(members, look) for members, look in masks if members.any()]


def draw_strokes(
    ax: Axes,
    film: xr.Dataset,
    x: Array,
    y: Array,
    std: Array | None = None,
    *,
    which: Mask | None = None,
    colour: str | None = None,
    label: str | None = None,
    **style: Any,
) -> list[Artist]:
    """Draw the triggers with a marker for each stroke, and with bars where `std` is given.

    Parameters
    ----------
    ax : Axes
    film : xarray.Dataset
    x, y, std : array, (trigger,)
        Places and half lengths of the bars, in the units of the axes.
    which : array of bool, optional
        Triggers that are drawn; default: all.
    colour : str, optional
        One colour for both strokes; default: that of each.
    label : str, optional
        Title of the points, to which the stroke is added; default: the stroke alone, and none for
        points of one colour.
    **style
        As for `matplotlib.axes.Axes.errorbar`.

    Returns
    -------
    list of Artist
        Points of each stroke that is drawn.
    """
    artists: list[Artist] = []
    for members, look in stroke_looks(film):
        chosen = members if which is None else members & which
        if not chosen.any():
            continue
        own: dict[str, Any] = {"linestyle": "none", "elinewidth": pt(0.7)} | look
        if colour is not None:
            full = look["markerfacecolor"] != "white"
            own |= {"color": colour, "markerfacecolor": colour if full else "white", "label": None}
        if label is not None:
            own["label"] = f"{label}, {look['label']}" if "stroke" in film else label
        own |= style
        bars = None if std is None else std[chosen]
        artists.append(ax.errorbar(x[chosen], y[chosen], bars, **own).lines[0])
    return artists


def draw_over_cycle(
    ax: Axes,
    film: xr.Dataset,
    quantity: str,
    value: Array,
    std: Array,
    expected: Array,
    line: dict[str, Any],
    **look: Any,
) -> list[Artist]:
    """Draw a quantity of the triggers with its bars, and the line of what is expected of them.

    No line crosses a dead point, nor leads from the last trigger back to the first.

    Parameters
    ----------
    ax : Axes
    film : xarray.Dataset
    quantity : str
        Label of the axis of the quantity.
    value, std, expected : array, (trigger,)
        In the units of the axis.
    line : dict
        Look of the line, as for `draw_line`.
    **look
        Look of the points, as for `draw_strokes`.

    Returns
    -------
    list of Artist
        Points of each stroke, then the line.
    """
    along = choose_abscissa(film)
    artists = draw_strokes(ax, film, along.values, value, std, **look)
    stretches = in_order(film, along.values)
    artists += draw_stretches(ax, stretches, along.values, expected, **line)
    label_abscissa(ax, along)
    ax.set_ylabel(quantity)
    return artists


def in_order(film: xr.Dataset, x: Array) -> list[npt.NDArray[np.intp]]:
    """Cut the triggers, in their order, where a line would join what does not follow.

    A line ends at the end of a stroke and of a turn, where `x` steps back, and where a step of `x`
    is much longer than those beside it. No line joins the last trigger to the first. Arguments that
    are not listed are those of `stroke_looks`.

    Parameters
    ----------
    x : array, (trigger,)
        Angle, time or number.

    Returns
    -------
    list of array of int
        Triggers of each stretch.

    Examples
    --------
    >>> [part.tolist() for part in in_order(xr.Dataset(), np.array([0, 1, 2, 6, 7.0]))]
    [[0, 1, 2], [3, 4]]

    A turn and a half of a disc, by angle:

    >>> angle = np.array([90.0, 180, 270, 0, 90, 180])
    >>> [part.tolist() for part in in_order(xr.Dataset(), angle)]
    [[0, 1, 2], [3, 4, 5]]
    """
    order = np.flatnonzero(np.isfinite(x))
    steps = np.diff(x[order])

    # a single step against those beside it is that from the end of a turn to the next
    beside = np.pad(np.sign(steps), 1, mode="edge")
    back = (beside[1:-1] * beside[:-2] < 0) & (beside[1:-1] * beside[2:] < 0)
    cut = back | find_gaps(np.where(back, 0.0, steps))
    if "stroke" in film:
        cut |= np.diff(film.stroke.values[order]) != 0
    return np.split(order, np.flatnonzero(cut) + 1)


def close_turn(film: xr.Dataset, along: Abscissa) -> tuple[npt.NDArray[np.intp], Array]:
    """Order the triggers of a disc over a whole turn, with the last before and the first after it.

    Returns
    -------
    (array of int, array)
        Triggers, and their places; as they are where there is no whole turn of a disc.

    Examples
    --------
    A film without settings is that of a crank:

    >>> close_turn(xr.Dataset(), Abscissa(np.array([0.0, 90, 180, 270]), "angle", True))[1].tolist()
    [0.0, 90.0, 180.0, 270.0]
    """
    place = along.values
    order = np.argsort(place)
    steps = np.diff(place[order], append=place[order[0]] + 360)
    gaps = find_gaps(np.concatenate([steps[-1:], steps, steps[:1]]))
    whole = along.whole_turn and driven_link(film) == "disc" and not gaps.any()
    if not whole or np.count_nonzero(np.diff(place) < 0) > 1:
        return np.arange(place.size), place
    order = np.concatenate([order[-1:], order, order[:1]])
    return order, place[order] + np.r_[-360.0, np.zeros(place.size), 360.0]


def find_gaps(steps: Array) -> Mask:
    """Find the steps that are much longer than the steps beside them.

    Examples
    --------
    Steps may change gradually, as those of a crank at even angles of its rocker do:

    >>> find_gaps(np.array([1.0, 1.5, 2.0, 5.0, 2.0])).tolist()
    [False, False, False, True, False]
    """
    steps = np.abs(steps)
    if steps.size < 2:  # nothing to compare with
        return np.zeros(steps.size, bool)
    before = np.r_[-np.inf, steps[:-1]]
    after = np.r_[steps[1:], -np.inf]
    return np.asarray(steps > _GAP * np.maximum(before, after))


def draw_stretches(
    ax: Axes, stretches: list[npt.NDArray[np.intp]], x: Array, y: Array, **line: Any
) -> list[Line2D]:
    """Draw a line that breaks between the stretches; a stretch of one trigger is a dash."""
    across, values = (broken(stretches, each) for each in (x, y))
    missing = np.isnan(np.pad(values, 1, constant_values=np.nan))
    alone = np.flatnonzero(missing[:-2] & missing[2:] & ~missing[1:-1])
    return draw_line(ax, across, values, marker="_", markevery=alone.tolist(), **line)


def broken(stretches: list[npt.NDArray[np.intp]], values: Array) -> Array:
    """Values of the stretches in order, with NaN between them, where a line breaks."""
    parts = [part for members in stretches for part in (values[members].astype(float), [np.nan])]
    return np.concatenate(parts[:-1]) if parts else np.array([])


def has_varying_speed(film: xr.Dataset) -> bool:
    """Whether the sliding or the joint speed differs by more than a hundredth between triggers."""
    name = "rocker_speed" if "rocker_speed" in film else "sliding_speed"
    if name not in film:
        return False
    speed = film[name].values
    return bool(np.ptp(speed) > _STEADY * np.abs(speed).max())


def have_partial_mean(film: xr.Dataset) -> Mask:
    """Triggers whose mean leaves out pixels as their film is beyond the measurable range.

    It is that of other pixels than at the other triggers, and in no exponent.

    Examples
    --------
    >>> film = xr.Dataset({"share_beyond_range": ("trigger", [0.0, 0.1])})
    >>> have_partial_mean(film).tolist()
    [False, True]
    """
    if "share_beyond_range" not in film:
        return np.zeros(film.sizes["trigger"], bool)
    return np.asarray(film.share_beyond_range.values > LARGEST_BEYOND)


def state_no_film(ax: Axes, film: xr.Dataset) -> None:
    """Write in empty axes which flags take the pixels of all triggers."""
    shares = describe_shares(flag_shares(film).mean(axis=0))
    state_empty(ax, f"no film thickness at any trigger\n{shares}")
