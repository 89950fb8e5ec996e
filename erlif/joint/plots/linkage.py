"""A crank-rocker: its positions and limits, and speed, transmission and power over a turn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from erlif.core.errors import OutputError
from erlif.io.files import expect_folder, refuse_existing
from erlif.joint.models.linkage import LinkageDesign, measure_linkage
from erlif.models.four_bar.measures import swept_box
from erlif.models.mechanism import CrankRocker
from erlif.show.plots import style
from erlif.show.plots.mechanism import pin_places
from erlif.show.plots.movie import check_movie, draw_pictures, write_pictures
from erlif.show.plots.style import MEAN, MINIMUM, MUTED, OUTWARD, RETURN, AnyFigure, pt, styled

# Frames of a movie: one for every 7.5 degrees of the crank.
POSITIONS = 48

_TURN = np.linspace(0.0, 2 * np.pi, 361)  # rad
_HEIGHT = 0.66  # of the width of the figure
_MARGIN = 0.08  # about the linkage, of its length
_OVER_A_TURN: dict[str, Any] = {"xlabel": "crank angle [°]", "xlim": (0, 360)}
_OVER_A_TURN["xticks"] = range(0, 361, 90)
_GOOD = 40.0  # degrees, the customary least transmission angle


@dataclass(frozen=True)
class LinkageView:
    """A crank-rocker on its axes, with marks at its crank angle, which `show` moves.

    Attributes
    ----------
    linkage : CrankRocker
        The four lengths.
    links : Line2D
        Links and joints, as one line with four markers.
    marks : tuple of Line2D
        Lines at the crank angle in the panels over a turn.
    """

    linkage: CrankRocker
    links: Line2D
    marks: tuple[Line2D, ...] = ()

    @property
    def figure(self) -> AnyFigure:
        """Figure of the links."""
        return style.figure_of(self.links)

    def show(self, crank_angle: float) -> None:
        """Move the linkage.

        Parameters
        ----------
        crank_angle : float
            Crank angle. [rad]
        """
        places = 1e3 * pin_places(self.linkage, np.array([crank_angle]))[0]
        self.links.set_data(places[:, 0], places[:, 1])
        degrees = np.degrees(crank_angle) % 360
        for mark in self.marks:
            mark.set_xdata([degrees, degrees])


@style.panel
def linkage_positions(
    design: LinkageDesign, *, crank_angle: float | None = None, ax: Axes = style.NEW
) -> LinkageView:
    """Draw a crank-rocker with both limits, the paths of its pins and of the coupler.

    Parameters
    ----------
    design : LinkageDesign
        From `erlif.joint.models.linkage`.
    crank_angle : float, optional
        Where it is drawn; default: half-way through the rising stroke. [rad]

    Returns
    -------
    LinkageView
        Dashed: the dead points; dotted: paths of both pins and of the middle of the coupler; the
        frame: the space.

    Examples
    --------
    >>> view = linkage_positions(example_linkage())
    >>> len(view.links.get_xdata())
    4
    """
    linkage = design.linkage
    places = 1e3 * pin_places(linkage, _TURN)
    middle = places[:, 1:3].mean(axis=1)
    paths = ((places[:, pin], MUTED, "paths of the pins") for pin in (1, 2))
    for path, colour, name in (*paths, (middle, MEAN, "path of the coupler's middle")):
        x, y = path.T
        style.draw_line(ax, x, y, colour, form=":", width=0.9, zorder=1, label=name)

    # the limits: folded and stretched
    ends = 1e3 * pin_places(linkage, np.array(linkage.dead_points()))
    angles, names = np.degrees(linkage.limits()), ("smallest", "largest")
    for links, angle, colour, name in zip(ends, angles, (RETURN, OUTWARD), names, strict=True):
        x, y = links.T
        label = f"{name} rocker angle {angle:.2f}°"
        style.draw_line(ax, x, y, colour, form="--", width=0.9, zorder=2, label=label)

    wide = f"links {1e3 * design.link_width:.4g} mm wide"
    label = f"space of {wide if design.link_width else 'the joint centres'}"
    box = 1e3 * np.array(swept_box(linkage.links, design.link_width))
    x, y = box[[0, 1, 1, 0, 0]], box[[2, 2, 3, 3, 2]]
    style.draw_line(ax, x, y, MUTED, width=0.6, zorder=0, label=label)
    pivots = places[0, [0, 3]]
    ax.plot(*pivots.T, "^", color=MUTED, markersize=pt(8), zorder=3)
    (drawn,) = ax.plot([], [], "o-", color=MINIMUM, linewidth=pt(1.8), zorder=4)

    ax.margins(_MARGIN)
    ax.set(xlabel="along the ground link [mm]", ylabel="across [mm]")
    ax.set_aspect("equal", adjustable="datalim")
    style.legend_above(ax, ncols=1)
    view = LinkageView(linkage, drawn)
    view.show(_rising(linkage) if crank_angle is None else crank_angle)
    return view


def _rising(linkage: CrankRocker) -> float:
    """Crank angle half-way from the smallest to the largest rocker angle. [rad]"""
    at_smallest, at_largest = linkage.dead_points()
    return (at_smallest + at_largest + 2 * np.pi) / 2


@style.panel
def transmission_over_crank(design: LinkageDesign, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the transmission angle over a turn of the crank. Arguments as in `linkage_positions`.

    Returns
    -------
    list of Artist
        The angle; its extremes are marked, and below 40 and above 140 degrees shaded.

    Examples
    --------
    >>> line, extremes = transmission_over_crank(example_linkage())
    >>> print(np.round(extremes.get_ydata(), 2))
    [ 76.3  104.69]
    """
    degrees = np.degrees(np.asarray(design.linkage.transmission_angle(_TURN)))
    line = ax.plot(np.degrees(_TURN), degrees, color=MINIMUM)
    extremes = ax.plot([0, 180], np.degrees(design.transmission), "o", color=RETURN)
    # below the minimum and above the maximum the curve is elsewhere
    least, greatest = np.degrees(design.transmission)
    for crank, value, side, place in ((0, least, -1, "top"), (180, greatest, 1, "bottom")):
        beside = pt(4), side * pt(4)
        style.write_beside(ax, f"{value:.1f}°", (crank, value), beside, verticalalignment=place)
    low, high = min(degrees.min(), 60.0) - 15, max(degrees.max(), 120.0) + 15
    for edges in ((0.0, _GOOD), (180.0 - _GOOD, 180.0)):
        ax.axhspan(*edges, color="#F2F2F2", zorder=-1)
    ax.axhline(90.0, color=MUTED, linewidth=pt(0.6), linestyle=":")
    if low < _GOOD or high > 180 - _GOOD:
        # the bands themselves are named once, and only where they are seen
        ax.patches[-1].set_label(f"beyond {_GOOD:g}° to {180 - _GOOD:g}°")
    ax.set(**_OVER_A_TURN, ylabel="transmission angle [°]", ylim=(max(low, 0.0), min(high, 180.0)))
    return [*line, *extremes]


@style.panel
def rocker_over_crank(design: LinkageDesign, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the rocker speed over a turn of the crank. Arguments as in `linkage_positions`.

    Returns
    -------
    list of Artist
        The rocker speed in rpm, or over the crank speed where none is given.

    Examples
    --------
    >>> (line,) = rocker_over_crank(example_linkage())
    >>> line.axes.get_ylabel()
    'rocker speed [rpm]'
    """
    known = np.isfinite(design.crank_speed)
    rate = np.asarray(design.linkage.rocker_speed(_TURN, crank_speed=1.0))
    speed = rate * (design.crank_speed * 30 / np.pi if known else 1.0)
    ax.axhline(0.0, color=MUTED, linewidth=pt(0.6), linestyle=":")
    ax.set(**_OVER_A_TURN, ylabel="rocker speed [rpm]" if known else "rocker speed / crank speed")
    return [*ax.plot(np.degrees(_TURN), speed, color=MINIMUM)]


@styled
def linkage_view(design: LinkageDesign, *, figure: AnyFigure | None = None) -> LinkageView:
    """Draw a crank-rocker with its limits, rocker speed and transmission angle, to be moved.

    Arguments that are not listed are those of `linkage_positions`.

    Parameters
    ----------
    figure : Figure or SubFigure, optional
        An empty one to draw in; default: a new figure, two columns wide.

    Returns
    -------
    LinkageView
        Its `show` moves the linkage, and marks of its angle on the curves.

    Examples
    --------
    >>> drawn = linkage_view(example_linkage())
    >>> drawn.show(np.pi)
    """
    figure = style.new_figure(style.TWO_COLUMNS, _HEIGHT * style.TWO_COLUMNS, given=figure)
    panels = figure.subplot_mosaic("pp;st", height_ratios=(1.5, 1))
    view = linkage_positions(design, ax=panels["p"])
    rocker_over_crank(design, ax=panels["s"])
    transmission_over_crank(design, ax=panels["t"])
    style.letter_panels(*(panels[name] for name in "pst"))
    look: dict[str, Any] = {"color": RETURN, "linewidth": pt(0.9), "label": "as drawn in (a)"}
    marks = [panels[name].axvline(0.0, zorder=3, **look) for name in "st"]
    for name in "st":
        style.legend_above(panels[name])
    figure.suptitle(_name(design))
    moving = replace(view, marks=tuple(marks))
    moving.show(_rising(design.linkage))
    return moving


def linkage_figure(design: LinkageDesign, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw a crank-rocker with its limits, rocker speed and transmission angle.

    Arguments as in `linkage_view`.

    Returns
    -------
    Figure or SubFigure
        Three panels.

    Examples
    --------
    >>> len(linkage_figure(example_linkage()).axes)
    3
    """
    return linkage_view(design, figure=figure).figure


def _name(design: LinkageDesign) -> str:
    """Lengths, swing and time ratio of a design in one line."""
    links = vars(design.linkage).items()
    lengths = ", ".join(f"{name} {1e3 * length:.1f}" for name, length in links)
    swing = f"swing {np.degrees(design.swing):.2f}°"
    return f"{lengths} mm; {swing}, time ratio {design.time_ratio:.3f}"


def linkage_movie(
    design: LinkageDesign,
    path: str | Path,
    *,
    positions: int = POSITIONS,
    frames_per_second: float = 24.0,
    overwrite: bool = False,
) -> Path:
    """Write a turn of a crank-rocker as GIF that repeats.

    Arguments that are not listed are those of `linkage_positions`.

    Parameters
    ----------
    path : path
        Ends in ``.gif``.
    positions : int
        Frames, evenly over a turn, 2 at least.
    frames_per_second : float
        From 0.1 to 60.
    overwrite : bool
        Replace an existing file.

    Returns
    -------
    Path
        The GIF.

    Raises
    ------
    OutputError
        If the file exists or cannot be written, or its suffix, positions or speed are others.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as directory:
    ...     movie = linkage_movie(example_linkage(), f"{directory}/turn.gif", positions=2)
    ...     movie.read_bytes()[:6]
    b'GIF89a'
    """
    path = Path(path)
    check_movie(path, frames_per_second, (".gif",))
    if positions < 2:
        raise OutputError(
            f"Expected a movie of 2 positions at least; got {positions}. Choose more of them."
        )
    refuse_existing(path, overwrite=overwrite)
    expect_folder(path)
    angles = 2 * np.pi * np.arange(positions) / positions
    with style.in_style(None):
        drawn = linkage_view(design)
        pictures = draw_pictures(drawn.figure, drawn.show, angles.tolist(), progress=False)
    return write_pictures(pictures, path, frames_per_second)


def example_linkage() -> LinkageDesign:
    """Return the crank-rocker of Farzaneh (2002), appendix A.2, at 114 rpm.

    Returns
    -------
    LinkageDesign
        Lengths of 5.5, 44, 26 and 51 cm.

    Examples
    --------
    >>> print(f"{np.degrees(example_linkage().swing):.2f}")
    24.43
    """
    rig = CrankRocker(crank=0.055, coupler=0.44, rocker=0.26, ground=0.51)
    return measure_linkage(rig, crank_speed=114 * np.pi / 30)


def write_linkage(design: LinkageDesign, path: str | Path, *, overwrite: bool = False) -> Path:
    """Write the figure of a crank-rocker, or its movie.

    Arguments that are not listed are those of `linkage_movie`.

    Parameters
    ----------
    path : path
        Ends in ``.png``, ``.pdf``, ``.svg``, or in ``.gif`` for the movie.

    Returns
    -------
    Path
        The figure, or the GIF of one turn of the crank.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as directory:
    ...     path = write_linkage(example_linkage(), f"{directory}/linkage.png")
    ...     path.read_bytes()[1:4]
    b'PNG'
    """
    path = Path(path)
    if path.suffix == ".gif":
        return linkage_movie(design, path, overwrite=overwrite)
    refuse_existing(path, overwrite=overwrite)
    with style.in_style(None):
        return style.save_figure(linkage_figure(design), path)
