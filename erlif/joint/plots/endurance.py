"""Endurance tests: what was logged over time, the onset of galling, two designs by their loads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from erlif.core.arrays import Array
from erlif.core.units import count_of
from erlif.joint.endurance import DesignComparison, EnduranceResult, FailureLoad
from erlif.joint.refusals import refusal
from erlif.show.plots import style
from erlif.show.plots.style import MUTED, OUTWARD, RETURN, TWO_COLUMNS, AnyFigure, pt, styled

_MINUTE = 60.0
_ROW = 1.15  # inch, height of a panel
_MARGIN = 0.02  # of the time axis
_NOTHING = 0.02  # of the highest load: a reading below zero by less is noise
_BEFORE = 90.0  # s that are drawn before the onset
_EDGE = 0.08  # of the range of friction, above and below
_LOADS = "#F0F0F0"  # behind the stages
_TABLE_ROW = 0.19  # inch, height of a row of the table
_RUN_ROW = 0.16  # inch, height of a run

_FEW_RUNS = 0.01  # least p-value from which it is stated

# File of the comparison of two designs.
DESIGNS = "designs.png"


@styled
def load_profile(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the load over time with the numbers of the stages. Farzaneh (2002), fig. 4-2.

    Parameters
    ----------
    result : EnduranceResult
        From `erlif.joint.analyse_endurance`.

    Returns
    -------
    list of Artist
        The line of the load; then, where the test has failed, the mark of the onset.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> line, *_ = load_profile(example_test())
    >>> line.axes.get_ylabel()
    'load [kN]'
    """
    ax = style.given_or_new(ax)
    load = result.test["load"].values / 1e3
    artists = _draw(result, load, ax, "load [kN]")
    for stage in result.loaded:
        middle = 0.5 * (stage.start + stage.end) / _MINUTE
        above = (middle, stage.load / 1e3)
        style.write_beside(ax, str(stage.number), above, (0, pt(2)), ha="center")
    ax.margins(y=0.3)  # for the numbers of the stages
    if np.nanmin(load) > -_NOTHING * np.nanmax(load):
        ax.set_ylim(bottom=0.0)
    return artists


@styled
def friction_over_test(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the friction coefficient over time, with the onset of galling. Figs. 4-4, 4-6 and 4-7.

    Arguments as in `load_profile`.

    Returns
    -------
    list of Artist
        The same for friction, which is known within the stages only.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> line, *_ = friction_over_test(example_test())
    >>> line.axes.get_ylabel()
    'friction coefficient'
    """
    return quantity_over_test(result, "friction", ax=ax)


@styled
def quantity_over_test(
    result: EnduranceResult, name: str, *, ax: Axes | None = None
) -> list[Artist]:
    """Draw one quantity over time, with the onset of galling. Figs. 4-3 to 4-11.

    Arguments that are not listed are those of `load_profile`.

    Parameters
    ----------
    name : str
        ``"load"``, ``"torque"``, ``"friction"``, ``"temperature"`` or ``"vibration"``.

    Returns
    -------
    list of Artist
        Line and onset, as those of the load, which has the numbers of the stages in addition.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> line, *_ = quantity_over_test(example_test(), "vibration")
    >>> line.axes.get_ylabel()
    'vibration [g]'
    """
    if name == "load":
        return load_profile(result, ax=ax)
    # friction without a load has no meaning
    within = name == "friction"
    values = _in_stages(result, name) if within else result.test[name].values
    return _draw(result, values, ax, _label(result, name))


def _label(result: EnduranceResult, name: str) -> str:
    """Label of the axis of a quantity."""
    if name == "friction":
        return "friction coefficient"
    unit = _UNITS.get(name) or result.test[name].attrs.get("units", "1")
    return name if unit == "1" else f"{name} [{unit}]"


_UNITS = {"torque": "N m", "temperature": "°C"}
_PAUSE = "in a pause of the log"

# panels of the figure of all that a test has logged
_PANELS = ("load", "torque", "friction", "temperature", "vibration")


@styled
def endurance_figure(result: EnduranceResult, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw all that a test has logged, one panel below the other. Figs. 4-3 and 4-10.

    Arguments as in `load_profile`.

    Returns
    -------
    Figure
        As many panels as there are columns, below each other; two columns wide.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> len(endurance_figure(example_test()).axes)
    5
    """
    names = [name for name in _PANELS if name in result.test]
    figure = style.given_figure(figure, TWO_COLUMNS, _ROW * len(names) + 0.2, text=0.6)
    figure.suptitle(result.name)
    panels = style.rows_or_columns(figure, len(names), sharex=True)
    for ax, name in zip(panels, names, strict=True):
        quantity_over_test(result, name, ax=ax)
        if ax is not panels[-1]:
            ax.set_xlabel("")
    style.letter_panels(*panels)
    style.legend_of_figure(figure, _keys(result))
    return figure


@styled
def failure_figure(result: EnduranceResult, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw torque and friction around the onset, with the posterior of the onset. Fig. 4-11.

    Arguments that are not listed are those of `endurance_figure`.

    Parameters
    ----------
    result
        As for `load_profile`; a test that has failed.

    Returns
    -------
    Figure
        One column wide: torque above friction.

    Raises
    ------
    EnduranceError
        If the test has no onset.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> [ax.get_ylabel() for ax in failure_figure(example_test()).axes]
    ['torque [N m]', 'friction coefficient']
    """
    onset = result.onset
    if onset is None:
        raise refusal("no_onset", name=result.name)
    figure = style.given_figure(figure, height=_ROW * 2.4, text=0.4)
    figure.suptitle(f"{result.name}: galling {_PAUSE if onset.pause else f'at {onset.time:.1f} s'}")
    stage = result.whole[onset.stage]
    time = result.test["time"].values[stage.samples]
    near = time > onset.earliest - _BEFORE
    panels = style.rows_or_columns(figure, 2, sharex=True)
    for ax, name in zip(panels, ("torque", "friction"), strict=True):
        values = result.test[name].values[stage.samples]
        style.draw_line(ax, time[near], values[near], OUTWARD, form=".-", width=0.6, size=2)
        ax.axvspan(onset.earliest, onset.latest, color=RETURN, alpha=0.25, linewidth=0)
        ax.axvline(onset.time, color=RETURN, linewidth=pt(0.8))
        ax.set_ylabel(_label(result, name))
        ax.ticklabel_format(useOffset=False)

    # level before and after, as they are printed
    after = onset.friction_before + onset.rise
    spans = (time[near][0], onset.earliest), (onset.latest, time[-1])
    for level, span in zip((onset.friction_before, after), spans, strict=True):
        style.draw_line(panels[1], span, (level, level), "black", form="--", width=0.8)
    interval = f"95 %: {onset.earliest:.1f} to {onset.latest:.1f} s"
    panels[0].set_title(interval, loc="right", color=RETURN)
    # the first and the last point are whole
    margin = _MARGIN * (time[-1] - time[near][0])
    panels[1].set(xlabel="time [s]", xlim=(time[near][0] - margin, time[-1] + margin))
    return figure


_FIGURES = ("load", "friction", "temperature")  # of one panel


def name_figures(result: EnduranceResult, *, overview: str = "") -> list[str]:
    """List the files that `write_endurance_figures` writes.

    Parameters
    ----------
    result : EnduranceResult
    overview : str
        File of all that the test has logged, from `name_overviews`; default: the test's name.

    Returns
    -------
    list of str
        As many as there are figures, the overview first.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> name_figures(example_test(galls=False))
    ['example.png', 'example_load.png', 'example_friction.png', 'example_temperature.png']
    """
    return [overview or f"{result.name}.png"] + [
        f"{result.name}_{kind}.png" for kind in _kinds(result)
    ]


def _kinds(result: EnduranceResult) -> list[str]:
    """Figures of a test beside that of all it has logged."""
    return [name for name in _FIGURES if name in result.test] + ["failure"] * bool(result.onset)


def name_overviews(names: Sequence[str]) -> dict[str, str]:
    """Name the figures of all that each of several tests has logged.

    Parameters
    ----------
    names : sequence of str
        Names of the tests.

    Returns
    -------
    dict of str to str
        Files by the names of the tests; none is a figure of another test or that of the designs.

    Examples
    --------
    >>> name_overviews(["run", "run_load"])
    {'run': 'run.png', 'run_load': 'run_load_all.png'}
    """
    taken = {f"{name}_{kind}.png" for name in names for kind in (*_FIGURES, "failure")}
    taken.add(DESIGNS)
    overviews = {}
    for name in names:
        file = f"{name}.png"
        while file in taken:
            file = f"{file.removesuffix('.png')}_all.png"
        taken.add(file)
        overviews[name] = file
    return overviews


def write_endurance_figures(
    result: EnduranceResult, folder: Path, *, overview: str = ""
) -> list[Path]:
    """Write the figures of a test. Arguments that are not listed are those of `name_figures`.

    Parameters
    ----------
    result : EnduranceResult
    folder : Path

    Returns
    -------
    list of Path
        All that the test has logged (figs. 4-3 and 4-10), the load (4-2), friction (4-4, 4-6 and
        4-7) and temperature (4-5, 4-8 and 4-9), and torque and friction around the onset (4-11).

    Examples
    --------
    >>> write_endurance_figures.__name__
    'write_endurance_figures'
    """
    written = []
    with style.in_style(None):
        for name, kind in zip(
            name_figures(result, overview=overview), ["", *_kinds(result)], strict=True
        ):
            if kind == "failure":
                figure: AnyFigure = failure_figure(result)
            elif kind:
                figure = _one_panel(result, kind)
            else:
                figure = endurance_figure(result)
            written.append(style.save_figure(figure, folder / name))
    return written


@styled
def _one_panel(result: EnduranceResult, kind: str) -> AnyFigure:
    """A quantity over the time of the test; friction twice, so that its running-in is seen."""
    twice = kind == "friction" and result.onset is not None
    figure = style.new_figure(height=_ROW * 3.2, text=0.4) if twice else style.new_figure()
    panels = style.rows_or_columns(figure, 1 + twice, sharex=True)
    for ax in panels:
        quantity_over_test(result, kind, ax=ax)
    if twice:
        panels[0].set_xlabel("")
        _limit_to_before(result, panels[1])
    figure.suptitle(result.name)
    style.legend_of_figure(figure, _keys(result))
    return figure


def _limit_to_before(result: EnduranceResult, ax: Axes) -> None:
    """Limits of friction before the onset."""
    onset = result.onset
    before = result.test["time"].values < (np.inf if onset is None else onset.earliest)
    friction = _in_stages(result, "friction")[before]
    low, high = np.nanmin(friction), np.nanmax(friction)
    margin = _EDGE * (high - low)
    ax.set_ylim(low - margin, high + margin)
    ax.set_title("limits of the friction before galling", loc="right")


def _keys(result: EnduranceResult) -> list[Artist]:
    """Keys of the marks: stages, and the onset in both units of time."""
    keys: list[Artist] = [style.swatch(_LOADS, "stage under load")]
    onset = result.onset
    if onset is not None:
        minutes = f"at {onset.time / _MINUTE:.2f} min = {onset.time:.1f} s"
        when = _PAUSE if onset.pause else minutes
        keys.append(Line2D([], [], color=RETURN, label=f"galling {when}, with its 95 % interval"))
    return keys


def _in_stages(result: EnduranceResult, name: str) -> Array:
    """A column within the stages, NaN between them."""
    kept = np.full(result.test.sizes["time"], np.nan)
    for stage in result.loaded:
        kept[stage.samples] = result.test[name].values[stage.samples]
    return kept


def _draw(result: EnduranceResult, values: Array, ax: Axes | None, label: str) -> list[Artist]:
    """A line over the time of the test, the stages shaded, the onset marked."""
    ax = style.given_or_new(ax)
    time = result.test["time"].values / _MINUTE
    artists: list[Artist] = list(style.draw_line(ax, time, values, OUTWARD, width=0.7))
    for stage in result.loaded:
        ax.axvspan(stage.start / _MINUTE, stage.end / _MINUTE, color=_LOADS, linewidth=0, zorder=0)
    if result.onset is not None:
        onset = result.onset
        ax.axvspan(
            onset.earliest / _MINUTE, onset.latest / _MINUTE, color=RETURN, alpha=0.3, linewidth=0
        )
        artists.append(ax.axvline(onset.time / _MINUTE, color=RETURN, linewidth=pt(0.8)))
    # a jump just before the end must not lie on the frame
    ax.ticklabel_format(useOffset=False)
    right = time[-1] + _MARGIN * (time[-1] - time[0])
    ax.set(xlim=(time[0], right), xlabel="time [min]", ylabel=label)
    return artists


@styled
def loads_of_designs(
    compared: DesignComparison,
    first: Sequence[FailureLoad],
    second: Sequence[FailureLoad],
    *,
    ax: Axes | None = None,
) -> list[Artist]:
    """Draw the loads at failure of the runs of two designs.

    Parameters
    ----------
    compared : DesignComparison
        From `erlif.joint.compare_designs`.
    first, second : sequence of FailureLoad
        Runs of both designs.

    Returns
    -------
    list of Artist
        For each design the loads at failure, and those of censored runs, which survived.

    Examples
    --------
    >>> from erlif.joint.endurance import compare_designs
    >>> failed = FailureLoad(36e3, 100.0, 32e3, True, 8)
    >>> runs = [failed, failed, FailureLoad(40e3, 100.0, 40e3, False, 9)]
    >>> compared = compare_designs(runs, runs)
    >>> _, survived, *_ = loads_of_designs(compared, runs, runs)
    >>> survived.get_xdata().tolist()
    [40.0]
    """
    ax = style.given_or_new(ax)
    artists: list[Artist] = []
    ticks, row = [], 0
    for runs, colour in ((first, OUTWARD), (second, RETURN)):
        rows = row + np.arange(len(runs))
        row += len(runs) + 1
        ticks.append(float(rows.mean()))

        # what a bearing carries lies between the load survived and the load at failure
        loads = np.array([run.load for run in runs]) / 1e3
        failed = np.array([run.failed for run in runs])
        lowest = np.array([run.survived for run in runs]) / 1e3
        known = failed & (lowest > 0)
        ax.hlines(rows[known], lowest[known], loads[known], color=colour, linewidth=pt(0.8))
        arrow = {"arrowstyle": "<-", "color": colour, "linewidth": pt(0.8)}
        for place in zip(loads[~failed], rows[~failed], strict=True):
            style.write_beside(ax, "", place, (pt(16), 0), arrowprops=arrow)
        for which, face in ((failed, colour), (~failed, "white")):
            look: dict[str, Any] = {"form": "o", "size": 3, "markerfacecolor": face}
            artists += style.draw_line(ax, loads[which], rows[which], colour, **look)
    ax.set(xlabel="load [kN]", ylim=(row - 1.2, -0.8))
    ax.set_yticks(ticks, [compared.first, compared.second])
    ax.ticklabel_format(axis="x", useOffset=False)
    ax.margins(x=0.15)
    marks = [
        Line2D([], [], linestyle="none", marker="o", color=MUTED, markerfacecolor=face, label=label)
        for face, label in ((MUTED, "failed"), ("white", "survived (censored)"))
    ]
    ax.legend(handles=marks, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return artists


@styled
def designs_figure(
    compared: DesignComparison,
    first: Sequence[FailureLoad],
    second: Sequence[FailureLoad],
    *,
    figure: AnyFigure | None = None,
) -> AnyFigure:
    """Draw the runs of two designs with a table of their comparison.

    Arguments as in `loads_of_designs`.

    Returns
    -------
    Figure
        The runs, and below them the table; one column wide.

    Examples
    --------
    >>> from erlif.joint.endurance import compare_designs
    >>> runs = [FailureLoad(load, 100.0, 32e3, True, 8) for load in (34e3, 36e3, 37e3)]
    >>> len(designs_figure(compare_designs(runs, runs), runs, runs).axes)
    2
    """
    rows = table_of_designs(compared)
    height, lines = _RUN_ROW * (len(first) + len(second) + 6), _TABLE_ROW * len(rows)
    figure = style.given_figure(figure, height=height + lines, text=lines)
    figure.suptitle(f"{compared.second} against {compared.first}")
    panels = figure.subplots(2, 1, height_ratios=(height - 4 * _TABLE_ROW, pt(lines)))
    loads_of_designs(compared, first, second, ax=panels[0])
    panels[1].axis("off")
    table = panels[1].table(rows, bbox=(0, 0, 1, 1), cellLoc="left")
    table.auto_set_font_size(False)
    table.set_fontsize(rcParams["font.size"])
    for cell in table.get_celld().values():
        cell.set_linewidth(pt(0.3))
    return figure


def table_of_designs(compared: DesignComparison) -> list[list[str]]:
    """Write the comparison of two designs as rows of a name and a value.

    Arguments as in `loads_of_designs`.

    Returns
    -------
    list of [str, str]

    Examples
    --------
    >>> from erlif.joint.endurance import compare_designs
    >>> runs = [FailureLoad(load, 100.0, 32e3, True, 8) for load in (34e3, 36e3, 37e3)]
    >>> table_of_designs(compare_designs(runs, runs))[0]
    ['first', '3 runs, 3 failures']
    """
    rows = [
        [name, f"{count_of(runs, 'run')}, {count_of(failures, 'failure')}"]
        for name, runs, failures in zip(
            (compared.first, compared.second), compared.runs, compared.failures, strict=True
        )
    ]
    known = np.isfinite(compared.ratio)
    ratio = f"{compared.ratio:.2f}" if known else "needs a failure of each design"
    rows.append(["ratio of the loads", ratio])
    if known:
        interval = f"{compared.low:.2f} to {compared.high:.2f} ({compared.model})"
        rows.append(["95 % interval", interval])
    p_value = f"p = {compared.log_rank:.2g}"
    if compared.least_p > _FEW_RUNS:
        p_value += f", at least {compared.least_p:.2g} of so few runs"
    return [*rows, ["log-rank test", p_value]]


def write_designs_figure(
    compared: DesignComparison,
    first: Sequence[FailureLoad],
    second: Sequence[FailureLoad],
    folder: Path,
) -> Path:
    """Write the figure of two designs.

    Arguments that are not listed are those of `loads_of_designs`.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    Path
        ``designs.png`` in that folder.

    Examples
    --------
    >>> write_designs_figure.__name__
    'write_designs_figure'
    """
    with style.in_style(None):
        return style.save_figure(designs_figure(compared, first, second), folder / DESIGNS)
