"""A designed joint: what is used of each limit, pressure, pv, temperature and wear."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from erlif.joint.sizing import FRICTION, BearingDesign, JointState
from erlif.show.plots import style
from erlif.show.plots.style import MEAN, MUTED, ONE_COLUMN, OUTWARD, RETURN, TWO_COLUMNS, styled

_TALL = 0.72  # height by width of the figure of four panels
_BAR = 0.16  # inch: height of a bar with its space
_MOST = 1.3  # share of what is allowed at which bars end
_ABOVE = 1.4  # free share above the curves, for the legend
_NEAR = 2.5  # times the highest pressure up to which the allowed one is drawn
_FLAT = math.radians(60.0)  # half contact angle beyond which a flat arc has no meaning
_ALIKE = 0.9  # mean over largest load from which one point stands for both
_DECADE = 10.0 ** (1 / 2)  # room on either side of the points of the pv diagram
_OVER: dict[str, Any] = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0)}  # of a legend
_INVALID: dict[str, Any] = {"facecolor": "white", "edgecolor": OUTWARD, "hatch": "//////"}
_POINT: dict[str, Any] = {"marker": "o", "linestyle": "", "color": OUTWARD}
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
        colour = RETURN if not step.holds else OUTWARD if step.kind == "limit" else MUTED
        # a step outside of its validity is hatched
        face = {"color": colour} if step.valid else {"color": "white", "hatch": _INVALID["hatch"]}
        bars += ax.barh(row, min(used, _MOST), 0.7, edgecolor=colour, linewidth=0.6, **face)
        if used > _MOST:
            ax.text(_MOST, row, "▸", va="center", ha="left", color=colour, clip_on=False)
    ax.axvline(1.0, **_LIMIT)
    titles = [f"{step.title} ({step.basis})" if step.basis else step.title for step in steps]
    ax.set_yticks(range(len(steps)), titles)
    ax.set(xlim=(0, _MOST), ylim=(len(steps) - 0.4, -0.6))
    ax.set_xlabel("part of the limit that is used")
    shown: list[tuple[bool, dict[str, Any], str]] = [
        (any(s.kind == "limit" for s in steps), {"color": OUTWARD}, "limit"),
        (any(s.kind != "limit" for s in steps), {"color": MUTED}, "recommendation"),
        (not all(s.holds for s in steps), {"color": RETURN}, "exceeded"),
        (not all(s.valid for s in steps), _INVALID, "equation not valid"),
    ]
    handles = [Patch(label=name, **look) for wanted, look, name in shown if wanted]
    ax.legend(handles=handles, ncols=4, columnspacing=1.0, **_OVER)
    return bars


@styled
def design_pressure(design: BearingDesign, *, ax: Axes | None = None) -> list[Artist]:
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
    ax = style.given_or_new(ax)
    assessment, state = design.assessment, JointState(design.joint)
    contact = state.contact
    reach = math.pi if contact is not None and contact.half_angle > math.pi / 2 else math.pi / 2
    angle = np.linspace(-reach, reach, 721)
    degrees, lines = np.degrees(angle), []

    highest = assessment.step("pressure_cosine").present
    if contact is not None:
        persson = state.pressure_over_arc(angle) / 1e6
        lines += ax.plot(degrees, persson, color=OUTWARD, label="eq. 9, Persson")
        highest = max(highest, contact.peak / 1e6)
        if contact.hertz_half_angle < _FLAT:
            edge = math.sin(contact.hertz_half_angle)
            inside = np.clip(1 - (np.sin(angle) / edge) ** 2, 0, None)
            flat = contact.hertz_peak / 1e6 * np.sqrt(inside) * (np.abs(angle) < math.pi / 2)
            lines += ax.plot(degrees, flat, color=RETURN, linestyle=":", label="eq. 8, Hertz")
            highest = max(highest, contact.hertz_peak / 1e6)

    front = np.abs(angle) <= math.pi / 2
    cosine = assessment.step("pressure_cosine").present * np.clip(np.cos(angle), 0, None)
    lines += ax.plot(degrees, cosine, color=MEAN, linestyle="--", label="eq. 7, cosine")
    mean = np.where(front, assessment.step("pressure_projected").present, 0.0)
    lines += ax.plot(degrees, mean, color=MUTED, linestyle="-.", label="eq. 6, projected")

    allowed = assessment.step("pressure_cosine").allowed[1]
    if allowed < _NEAR * highest:
        ax.axhline(allowed, color="black", linewidth=0.8, label="hardness / safety")
        highest = max(highest, allowed)
    ax.set(xlabel="angle from the load [degree]", ylabel="pressure [MPa]")
    ax.set(xlim=(degrees[0], degrees[-1]), ylim=(0, _ABOVE * highest))
    ax.set_xticks(np.linspace(degrees[0], degrees[-1], 5))
    style.frame_legend(ax, loc="upper center", ncols=2, columnspacing=1.0)
    return list(lines)


@styled
def design_pv(design: BearingDesign, *, ax: Axes | None = None) -> list[Artist]:
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
    ax = style.given_or_new(ax)
    joint, ring = design.joint, design.joint.bushing
    ax.set(xlabel="projected pressure [MPa]", ylabel="sliding speed [mm/s]")
    speed = design.assessment.step("speed").present
    if not speed > 0:
        style.state_empty(ax, "no motion")
        return []

    largest = design.assessment.step("pressure_projected").present
    mean = largest * joint.moving_force / joint.force
    halves = [
        part.yield_stress / 2e6 for part in (joint.pin, ring) if part.yield_stress is not None
    ]
    strength = min(halves) if ring.yield_stress is not None else math.inf

    pressures = [largest, mean, *([strength] if math.isfinite(strength) else [])]
    speeds = [speed, 20.0]
    if ring.pressure is not None:
        pressures.append(ring.pressure / 1e6)
    if ring.speed is not None:
        speeds.append(ring.speed * 1e3)
    across = (min(pressures) / _DECADE, max(pressures) * _DECADE)
    up = (min(speeds) / _DECADE, max(speeds) * _DECADE * _ABOVE)

    if math.isfinite(strength):
        ax.plot([strength] * 2, [up[0], 20.0], color=MUTED, label="eq. 5: yield / 2 to 0.02 m/s")
        ax.plot([across[0], strength], [20.0] * 2, color=MUTED)
    if ring.pressure is not None:
        ax.axvline(ring.pressure / 1e6, label="limits of the bushing", **_LIMIT)
    if ring.speed is not None:
        ax.axhline(ring.speed * 1e3, **_LIMIT)
    if ring.pv is not None:
        # W/mm2 over MPa is m/s
        x = np.array(across)
        ax.plot(x, ring.pv / 1e6 / x * 1e3, color=RETURN, linestyle="--", label="pv limit")

    # loads that are alike would hide each other
    alike = mean > _ALIKE * largest
    name = "largest and mean load" if alike else "largest load"
    points: list[Artist] = list(ax.plot(largest, speed, label=name, **_POINT))
    if not alike:
        square = _POINT | {"marker": "s", "color": MEAN, "markerfacecolor": "white"}
        points += ax.plot(mean, speed, label="mean load", **square)
    ax.set(xscale="log", yscale="log", xlim=across, ylim=up)
    for axis in (ax.xaxis, ax.yaxis):
        style.plain_log_axis(axis)
    style.frame_legend(ax, loc="best")
    return points


@styled
def design_temperature(design: BearingDesign, *, ax: Axes | None = None) -> list[Artist]:
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
    ax = style.given_or_new(ax)
    joint, step = design.joint, design.assessment.step("temperature")
    ax.set(xlabel="friction", ylabel="temperature [°C]")
    if step.missing:
        style.state_empty(ax, "conductivity or motion\nnot known")
        return []

    outside, limit = joint.outside_temperature, step.allowed[1]
    friction = np.array([0.0, max(FRICTION[1], 1.1 * joint.friction)])
    slope = (step.present - outside) / joint.friction if joint.friction > 0 else 0.0
    ax.axvspan(*FRICTION, color="#F2F2F2", zorder=-2, label="range of the guide")
    surface = outside + slope * friction
    lines: list[Artist] = [*ax.plot(friction, surface, color=OUTWARD, label="surface")]
    lines += ax.plot(joint.friction, step.present, label="this joint", **_POINT)
    ax.axhline(limit, label="limit", **_LIMIT)
    ax.axhline(outside, color=MUTED, linewidth=0.6, linestyle=":", label="outside")
    low, high = sorted((outside, max(limit, surface[1])))
    ax.set(xlim=friction, ylim=(low - 0.1 * (high - low), high + 0.1 * (high - low) + 1.0))
    # above the axes, where it covers neither the curve nor the shading
    ax.legend(ncols=3, columnspacing=0.8, handlelength=1.5, **_OVER)
    return lines


@styled
def design_wear(design: BearingDesign, *, ax: Axes | None = None) -> list[Artist]:
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
    ax = style.given_or_new(ax)
    step = design.assessment.step("wear")
    ax.set(xlabel="time in motion [h]", ylabel="worn depth [mm]")
    if step.missing:
        style.state_empty(ax, "wear rate, life or motion\nnot known")
        return []

    life = (design.joint.life or 0.0) / 3600
    limit = step.allowed[1]
    end = 1.25 * life
    lines = ax.plot([0, end], [0, 1.25 * step.present], color=OUTWARD, label="worn depth")
    ax.axvline(life, color=MUTED, linewidth=0.6, linestyle=":", label="life")
    highest = max(1.25 * step.present, 1e-9)
    if math.isfinite(limit):
        reached = step.number("life to the largest wear")
        if limit < _NEAR * highest:
            ax.axhline(limit, label="largest wear", **_LIMIT)
            highest = max(highest, limit)
        elif math.isfinite(reached):
            hours = f"{float(f'{reached:.2g}'):.10g}"
            ax.set_title(f"largest wear, {limit:g} mm, after {hours} h", fontsize="medium")
    ax.set(xlim=(0, end), ylim=(0, _ABOVE * highest))
    style.frame_legend(ax, loc="upper left", ncols=3, columnspacing=1.0)
    return list(lines)


@styled
def design_figure(design: BearingDesign) -> Figure:
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
def design_margins_figure(design: BearingDesign) -> Figure:
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
