"""A designed joint: what is used of each limit, pressure, pv, temperature and wear."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.joint.sizing import FRICTION, BearingDesign, JointState
from erlif.show.plots import style
from erlif.show.plots.style import (
    MEAN,
    MUTED,
    ONE_COLUMN,
    OUTWARD,
    RETURN,
    TWO_COLUMNS,
    Curve,
    styled,
)

_TALL = 0.72  # height by width of the figure of four panels
_BAR = 0.16  # inch: height of a bar with its space
_MOST = 1.3  # share of what is allowed at which bars end
_NEAR = 2.5  # times the highest pressure up to which the allowed one is drawn
_FLAT = math.radians(60.0)  # half contact angle beyond which a flat arc has no meaning
_ALIKE = 0.9  # mean over largest load from which one point stands for both
_DECADE = 10.0 ** (1 / 2)  # room on either side of the points of the pv diagram
_KINDS = {"limit": OUTWARD, "recommendation": MUTED, "exceeded": RETURN}  # colours of bars
_LIMIT: dict[str, Any] = {"color": "black", "linewidth": 0.8}


@styled
def design_margins(design: BearingDesign, *, ax: Axes | None = None) -> list[Artist]:
    """Draw how much of each limit and recommendation is used.

    Parameters
    ----------
    design : BearingDesign
        Joint, dimensions and steps, as `erlif.joint.design` returns them.

    Returns
    -------
    list of Artist
        One bar for each step with a margin, in the order of the guide from the top.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> bars = design_margins(example_design())
    >>> bars[0].axes.get_xlabel()
    'part of the limit that is used'
    """
    steps = [
        step
        for step in design.assessment.steps
        if step.kind in ("limit", "recommendation") and not math.isnan(step.margin)
    ]
    ax = style.given_or_new(ax, height=_BAR * len(steps) + 0.6)
    bars: list[Artist] = []
    for row, step in enumerate(steps):
        used = math.inf if step.margin <= -1 else 1 / (1 + step.margin)  # the wrong sign
        kind = step.kind if step.holds else "exceeded"
        colour = _KINDS[kind]
        look: dict[str, Any] = {"color": colour, "label": kind}
        if not step.valid:
            look = {"color": "white", "hatch": "//////", "label": "equation not valid"}
        bars += ax.barh(row, min(used, _MOST), 0.7, edgecolor=colour, linewidth=0.6, **look)
        if used > _MOST:
            ax.text(_MOST, row, "▸", va="center", ha="left", color=colour, clip_on=False)
    ax.axvline(1.0, **_LIMIT)
    titles = [f"{step.title} ({step.basis})" if step.basis else step.title for step in steps]
    ax.set_yticks(range(len(steps)), titles)
    ax.set(xlim=(0, _MOST), ylim=(len(steps) - 0.4, -0.6))
    ax.set_xlabel("part of the limit that is used", loc="right")
    style.legend_above(ax)
    return bars


@style.panel
def design_pressure(design: BearingDesign, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the pressure over the arc after eqs. 6 to 9. Arguments as in `design_margins`.

    Returns
    -------
    list of Artist
        The curves.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> [line.get_label() for line in design_pressure(example_design())][:2]
    ['eq. 9, Persson', 'eq. 7, cosine']
    """
    assessment, state = design.assessment, JointState(design.joint)
    contact = state.contact
    reach = math.pi if contact is not None and contact.half_angle > math.pi / 2 else math.pi / 2
    angle = np.linspace(-reach, reach, 721)
    degrees = np.degrees(angle)
    curves: list[Curve] = []
    if contact is not None:
        persson = state.pressure_over_arc(angle) / 1e6
        curves.append(Curve(degrees, persson, OUTWARD, "eq. 9, Persson", {"form": "-"}))
        if contact.hertz_half_angle < _FLAT:
            edge = math.sin(contact.hertz_half_angle)
            inside = np.clip(1 - (np.sin(angle) / edge) ** 2, 0, None)
            flat = contact.hertz_peak / 1e6 * np.sqrt(inside) * (np.abs(angle) < math.pi / 2)
            curves.append(Curve(degrees, flat, RETURN, "eq. 8, Hertz", {"form": ":"}))

    cosine = assessment.step("pressure_cosine")
    mean = assessment.step("pressure_projected").present * (np.abs(angle) <= math.pi / 2)
    over_arc = cosine.present * np.clip(np.cos(angle), 0, None)
    curves.append(Curve(degrees, over_arc, MEAN, "eq. 7, cosine", {"form": "--"}))
    curves.append(Curve(degrees, mean, MUTED, "eq. 6, projected", {"form": "-."}))
    if cosine.allowed[1] < _NEAR * max(np.max(one.y) for one in curves):
        ax.axhline(cosine.allowed[1], label="hardness / safety", **_LIMIT)
    limits = {"xticks": np.linspace(degrees[0], degrees[-1], 5), "xmargin": 0, "ylim": (0, None)}
    return style.draw_curves(ax, curves, "angle from the load [degree]", "pressure [MPa]", **limits)


@style.panel
def design_pv(design: BearingDesign, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw pressure and speed of the joint with the limits of the bushing.

    Arguments as in `design_margins`.

    Returns
    -------
    list of Artist
        The points of the joint at its largest and its mean load, one where they are alike; empty
        without motion.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> [point.get_label() for point in design_pv(example_design())]
    ['largest load', 'mean load']
    """
    joint, ring = design.joint, design.joint.bushing
    speed = design.assessment.step("speed").present
    labels = "projected pressure [MPa]", "sliding speed [mm/s]"
    if not speed > 0:
        style.state_empty(ax, "no motion")
        return style.draw_curves(ax, (), *labels)

    largest = design.assessment.step("pressure_projected").present
    mean = largest * joint.moving_force / joint.force
    halves = [
        part.yield_stress / 2e6 for part in (joint.pin, ring) if part.yield_stress is not None
    ]
    strength = min(halves) if ring.yield_stress is not None else math.inf

    pressures = np.array([largest, mean, strength, (ring.pressure or math.inf) / 1e6])
    speeds = np.array([speed, 20.0, (ring.speed or 0.02) * 1e3])
    pressures = pressures[np.isfinite(pressures)]
    across = np.array([pressures.min() / _DECADE, pressures.max() * _DECADE])
    up = (speeds.min() / _DECADE, speeds.max() * _DECADE)

    if math.isfinite(strength):
        corner = [strength, strength, across[0]], [up[0], 20.0, 20.0]
        ax.plot(*corner, color=MUTED, label="eq. 5: yield / 2 to 0.02 m/s")
    if ring.pressure is not None:
        ax.axvline(ring.pressure / 1e6, label="limits of the bushing", **_LIMIT)
    if ring.speed is not None:
        ax.axhline(ring.speed * 1e3, **_LIMIT)
    if ring.pv is not None:
        # W/mm2 over MPa is m/s
        limit = ring.pv / 1e6 / across * 1e3
        style.draw_line(ax, across, limit, RETURN, form="--", label="pv limit")

    # loads that are alike would hide each other
    alike = mean > _ALIKE * largest
    name = "largest and mean load" if alike else "largest load"
    points = [Curve(largest, speed, OUTWARD, name, {"form": "o"})]
    if not alike:
        square = {"form": "s", "markerfacecolor": "white"}
        points.append(Curve(mean, speed, MEAN, "mean load", square))
    scales: dict[str, Any] = {"xscale": "log", "yscale": "log", "xlim": across, "ylim": up}
    return style.draw_curves(ax, points, *labels, **scales)


@style.panel
def design_temperature(design: BearingDesign, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the temperature of the surface against friction.

    Arguments as in `design_margins`.

    Returns
    -------
    list of Artist
        The line, and the point of the joint; empty where the temperature is not known.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> len(design_temperature(example_design()))
    2
    """
    joint, step = design.joint, design.assessment.step("temperature")
    labels = "friction", "temperature [°C]"
    if step.missing:
        style.state_empty(ax, "conductivity or motion\nnot known")
        return style.draw_curves(ax, (), *labels)

    outside, limit = joint.outside_temperature, step.allowed[1]
    friction = np.array([0.0, max(FRICTION[1], 1.1 * joint.friction)])
    slope = (step.present - outside) / joint.friction if joint.friction > 0 else 0.0
    ax.axvspan(*FRICTION, color="#F2F2F2", zorder=-2, label="range of the guide")
    surface = outside + slope * friction
    ax.axhline(limit, label="limit", **_LIMIT)
    ax.axhline(outside, color=MUTED, linewidth=0.6, linestyle=":", label="outside")
    curves = (
        Curve(friction, surface, OUTWARD, "surface"),
        Curve(joint.friction, step.present, OUTWARD, "this joint", {"form": "o"}),
    )
    return style.draw_curves(ax, curves, *labels, xlim=friction, ymargin=0.1)


@style.panel
def design_wear(design: BearingDesign, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw the worn depth over the life. Arguments as in `design_margins`.

    Returns
    -------
    list of Artist
        The line; empty where the wear is not known.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> [line.get_label() for line in design_wear(example_design())]
    ['worn depth']
    """
    step = design.assessment.step("wear")
    labels = "time in motion [h]", "worn depth [mm]"
    if step.missing:
        style.state_empty(ax, "wear rate, life or motion\nnot known")
        return style.draw_curves(ax, (), *labels)

    life = (design.joint.life or 0.0) / 3600
    limit = step.allowed[1]
    end = 1.25 * life
    line = Curve([0, end], [0, 1.25 * step.present], OUTWARD, "worn depth")
    ax.axvline(life, color=MUTED, linewidth=0.6, linestyle=":", label="life")
    if limit < _NEAR * 1.25 * step.present:
        ax.axhline(limit, label="largest wear", **_LIMIT)
    elif math.isfinite(limit) and step.present > 0:
        hours = float(f"{step.number('life to the largest wear'):.2g}")
        ax.plot([], [], " ", label=f"largest wear, {limit:g} mm, after {hours:.10g} h")
    return style.draw_curves(ax, [line], *labels, xlim=(0, end), ylim=(0, None))


@styled
def design_figure(design: BearingDesign) -> style.AnyFigure:
    """Combine pressure over the arc, pv diagram, temperature and wear of a joint.

    Arguments as in `design_margins`.

    Returns
    -------
    Figure
        Two journal columns wide.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> len(design_figure(example_design()).axes)
    4
    """
    figure = style.new_figure(TWO_COLUMNS, _TALL * TWO_COLUMNS)
    drawings = (design_pressure, design_pv, design_temperature, design_wear)
    style.draw_panels(figure.subplots(2, 2).ravel(), drawings, design)
    return figure


@styled
def design_margins_figure(design: BearingDesign) -> style.AnyFigure:
    """Draw the margins in a figure of their own. Arguments as in `design_margins`.

    Returns
    -------
    Figure
        One and a half columns wide, as high as there are steps.

    Examples
    --------
    >>> from erlif.joint.sizing.design import example_design
    >>> len(design_margins_figure(example_design()).axes)
    1
    """
    count = sum(not math.isnan(step.margin) for step in design.assessment.steps)
    figure = style.new_figure(1.45 * ONE_COLUMN, _BAR * count + 0.6)
    design_margins(design, ax=figure.add_subplot())
    return figure
