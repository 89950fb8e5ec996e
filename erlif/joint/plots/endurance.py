"""Endurance tests: what was logged over time, the onset of galling, two designs by their loads."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array
from erlif.core.errors import EnduranceError
from erlif.core.units import count_of
from erlif.joint.endurance import DesignComparison, EnduranceResult, FailureLoad
from erlif.show.plots import style
from erlif.show.plots.style import MUTED, OUTWARD, RETURN, TWO_COLUMNS, AnyFigure, Curve, pt, styled

_MINUTE, _KILO = 60.0, 1e3
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


@style.panel
def quantity_over_test(result: EnduranceResult, name: str, *, ax: Axes = style.NEW) -> list[Artist]:
    """Draw one quantity over time, with the onset of galling. Figs. 4-2 to 4-11.

    The load has the numbers of the stages; friction is known within the stages only.

    Parameters
    ----------
    result : EnduranceResult
        From `erlif.joint.analyse_endurance`.
    name : str
        ``"load"``, ``"torque"``, ``"friction"``, ``"temperature"`` or ``"vibration"``.

    Returns
    -------
    list of Artist
        The line; then, where the test has failed, the mark of the onset.

    Examples
    --------
    >>> from erlif.joint.plots.example import example_test
    >>> line, *_ = quantity_over_test(example_test(), "vibration")
    >>> line.axes.get_ylabel()
    'vibration [g]'
    """
    values = result.test[name].values
    if name == "friction":  # without a load it has no meaning
        values = _in_stages(result, name)
    time = result.test["time"].values / _MINUTE
    shown = values / _KILO if name == "load" else values
    line = Curve(time, shown, OUTWARD, None, {"width": 0.7})
    for stage in result.loaded:
        start, end = stage.start / _MINUTE, stage.end / _MINUTE
        ax.axvspan(start, end, color=_LOADS, linewidth=0, zorder=0, label="stage under load")
        if name == "load":
            above = (0.5 * (start + end), stage.load / _KILO)
            style.write_beside(ax, str(stage.number), above, (0, pt(2)), ha="center")
    marks = _mark_onset(ax, result, _MINUTE)
    # a jump just before the end must not lie on the frame
    right = time[-1] + _MARGIN * (time[-1] - time[0])
    labels = "time [min]", _label(result, name)
    lines = style.draw_curves(ax, [line], *labels, xlim=(time[0], right))
    style.legend_above(ax, ncols=1)
    ax.ticklabel_format(useOffset=False)
    if name == "load":
        ax.margins(y=0.3)  # for the numbers of the stages
        if np.nanmin(values) > -_NOTHING * np.nanmax(values):
            ax.set_ylim(bottom=0.0)
    return [*lines, *marks]


def _mark_onset(ax: Axes, result: EnduranceResult, unit: float) -> list[Artist]:
    """Mark the onset of galling and its interval, where there is one, in a unit of time. [s]"""
    if result.onset is None:
        return []
    onset = result.onset
    ax.axvspan(onset.earliest / unit, onset.latest / unit, color=RETURN, alpha=0.3, linewidth=0)
    minutes = f"at {onset.time / _MINUTE:.2f} min = {onset.time:.1f} s"
    label = f"galling {_PAUSE if onset.pause else minutes}, with its 95 % interval"
    return [ax.axvline(onset.time / unit, color=RETURN, linewidth=pt(0.8), label=label)]


def _label(result: EnduranceResult, name: str) -> str:
    """Label of the axis of a quantity; a vibration has the unit of its log."""
    unit = result.test[name].attrs.get("units", "1")
    return _LABELS[name] or (name if unit == "1" else f"{name} [{unit}]")


# panels of the figure of all that a test has logged
_LABELS = {
    "load": "load [kN]",
    "torque": "torque [N m]",
    "friction": "friction coefficient",
    "temperature": "temperature [°C]",
    "vibration": "",
}
_PAUSE = "in a pause of the log"


@styled
def endurance_figure(result: EnduranceResult, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw all that a test has logged, one panel below the other. Figs. 4-3 and 4-10.

    Arguments as in `quantity_over_test`.

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
    names = [name for name in _LABELS if name in result.test]
    figure = style.new_figure(TWO_COLUMNS, _ROW * len(names) + 0.2, given=figure, text=0.6)
    figure.suptitle(result.name)
    panels = style.rows_or_columns(figure, len(names), sharex=True)
    for ax, name in zip(panels, names, strict=True):
        quantity_over_test(result, name, ax=ax)
    style.letter_panels(*panels)
    style.legend_of_figure(figure)
    return figure


@styled
def failure_figure(result: EnduranceResult, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw torque and friction around the onset, with the posterior of the onset. Fig. 4-11.

    Arguments that are not listed are those of `endurance_figure`.

    Parameters
    ----------
    result
        As for `quantity_over_test`; a test that has failed.

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
        raise EnduranceError(
            f"Expected a test with an onset of galling to draw; {result.name} survived. Draw "
            "endurance_figure in its place."
        )
    figure = style.new_figure(given=figure, height=_ROW * 2.4, text=0.4)
    figure.suptitle(f"{result.name}: galling {_PAUSE if onset.pause else f'at {onset.time:.1f} s'}")
    stage = result.whole[onset.stage]
    time = result.test["time"].values[stage.samples]
    near = time > onset.earliest - _BEFORE
    panels = style.rows_or_columns(figure, 2, sharex=True)
    for ax, name in zip(panels, ("torque", "friction"), strict=True):
        values = result.test[name].values[stage.samples]
        style.draw_line(ax, time[near], values[near], OUTWARD, form=".-", width=0.6, size=2)
        _mark_onset(ax, result, 1.0)
        ax.set_ylabel(_label(result, name))
        ax.ticklabel_format(useOffset=False)

    # level before and after, as they are printed
    after = onset.friction_before + onset.rise
    spans = (time[near][0], onset.earliest), (onset.latest, time[-1])
    for level, span in zip((onset.friction_before, after), spans, strict=True):
        style.draw_line(panels[1], span, (level, level), "black", form="--", width=0.8)
    interval = f"95 %: {onset.earliest:.1f} to {onset.latest:.1f} s"
    panels[0].set_title(interval, loc="right", color=RETURN)
    panels[1].set(xlabel="time [s]", xmargin=_MARGIN)  # the first and the last point are whole
    return figure


_FIGURES = ("load", "friction", "temperature")  # of one panel


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
    """Write the figures of a test.

    Parameters
    ----------
    result : EnduranceResult
    folder : Path
    overview : str
        File of all that the test has logged, from `name_overviews`; default: the test's name.

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
    with style.in_style(None):
        figures = {overview or f"{result.name}.png": endurance_figure(result)}
        for name in _FIGURES:
            if name in result.test:
                figures[f"{result.name}_{name}.png"] = _one_panel(result, name)
        if result.onset is not None:
            figures[f"{result.name}_failure.png"] = failure_figure(result)
        return [style.save_figure(figure, folder / name) for name, figure in figures.items()]


@styled
def _one_panel(result: EnduranceResult, kind: str) -> AnyFigure:
    """A quantity over the time of the test; friction twice, so that its running-in is seen."""
    onset = result.onset if kind == "friction" else None
    count = 1 if onset is None else 2
    figure = style.new_figure(height=_ROW * (1.2 + count), text=0.4)
    panels = style.rows_or_columns(figure, count, sharex=True)
    for ax in panels:
        quantity_over_test(result, kind, ax=ax)
    if onset is not None:
        panels[0].set_xlabel("")
        friction = _in_stages(result, kind)[result.test["time"].values < onset.earliest]
        low, high = np.nanmin(friction), np.nanmax(friction)
        margin = _EDGE * (high - low)
        panels[1].set_ylim(low - margin, high + margin)
        panels[1].set_title("limits of the friction before galling", loc="right")
    figure.suptitle(result.name)
    style.legend_of_figure(figure, ncols=1)
    return figure


def _in_stages(result: EnduranceResult, name: str) -> Array:
    """A column within the stages, NaN between them."""
    kept = np.full(result.test.sizes["time"], np.nan)
    for stage in result.loaded:
        kept[stage.samples] = result.test[name].values[stage.samples]
    return kept


@style.panel
def loads_of_designs(
    compared: DesignComparison,
    first: Sequence[FailureLoad],
    second: Sequence[FailureLoad],
    *,
    ax: Axes = style.NEW,
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
    ax.set(xlabel="load [kN]", ylim=(row - 1.2, -0.8), xmargin=0.15)
    ax.set_yticks(ticks, [compared.first, compared.second])
    ax.ticklabel_format(axis="x", useOffset=False)
    for face, label in ((MUTED, "failed"), ("white", "survived (censored)")):
        style.draw_line(ax, [], [], MUTED, form="o", markerfacecolor=face, label=label)
    style.legend_above(ax)
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
    figure = style.new_figure(given=figure, height=height + lines, text=lines)
    figure.suptitle(f"{compared.second} against {compared.first}")
    panels = figure.subplots(2, 1, height_ratios=(height - 4 * _TABLE_ROW, pt(lines)))
    loads_of_designs(compared, first, second, ax=panels[0])
    panels[1].axis("off")
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    table = panels[1].table(rows, bbox=(0, 0, 1, 1), cellLoc="left", colWidths=widths)
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
