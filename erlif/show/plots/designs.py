"""Two designs of bearings by their loads at failure."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from erlif.core.units import count_of
from erlif.joint.endurance import DesignComparison, FailureLoad
from erlif.show.plots import style
from erlif.show.plots.endurance import DESIGNS
from erlif.show.plots.style import MUTED, ONE_COLUMN, OUTWARD, RETURN, AnyFigure, pt, styled

_LINE = 0.19  # inch, height of a row of the table
_RUN = 0.16  # inch, height of a run


@styled
def loads_of_designs(
    compared: DesignComparison,
    first: Sequence[FailureLoad],
    second: Sequence[FailureLoad],
    *,
    ax: Axes | None = None,
) -> list[Artist]:
    """Draw the loads at failure of the runs of two designs.

    Arguments that are not listed are those of `erlif.plots`.

    Parameters
    ----------
    compared : DesignComparison
        From `erlif.compare_designs`.
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
    ticks, labels, row = [], [], 0
    for name, runs, colour in (
        (compared.first, first, OUTWARD),
        (compared.second, second, RETURN),
    ):
        rows = row + np.arange(len(runs))
        row += len(runs) + 1
        ticks.append(float(rows.mean()))
        labels.append(name)

        # what a bearing carries lies between the load survived and the load at failure
        loads = np.array([run.load for run in runs]) / 1e3
        failed = np.array([run.failed for run in runs])
        lowest = np.array([run.survived for run in runs]) / 1e3
        known = failed & (lowest > 0)
        ax.hlines(rows[known], lowest[known], loads[known], color=colour, linewidth=pt(0.8))
        artists += ax.plot(loads[failed], rows[failed], "o", color=colour, markersize=pt(3))
        for load, at in zip(loads[~failed], rows[~failed], strict=True):
            ax.annotate(
                "",
                (load, at),
                xytext=(pt(16), 0),
                textcoords="offset points",
                arrowprops={"arrowstyle": "<-", "color": colour, "linewidth": pt(0.8)},
            )
        artists += ax.plot(
            loads[~failed],
            rows[~failed],
            "o",
            color=colour,
            markerfacecolor="white",
            markersize=pt(3),
        )
    ax.set(xlabel="load [kN]", ylim=(row - 1.2, -0.8))
    ax.set_yticks(ticks, labels)
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
        One column wide.

    Examples
    --------
    >>> from erlif.joint.endurance import compare_designs
    >>> runs = [FailureLoad(load, 100.0, 32e3, True, 8) for load in (34e3, 36e3, 37e3)]
    >>> len(designs_figure(compare_designs(runs, runs), runs, runs).axes)
    2
    """
    rows = table_of_designs(compared)
    height, lines = _RUN * (len(first) + len(second) + 6), _LINE * len(rows)
    figure = style.given_figure(figure, ONE_COLUMN, height + lines, text=lines)
    figure.suptitle(f"{compared.second} against {compared.first}")
    panels = figure.subplots(2, 1, height_ratios=(height - 4 * _LINE, pt(lines)))
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
    if np.isfinite(compared.ratio):
        rows += [
            ["ratio of the loads", f"{compared.ratio:.2f}"],
            ["95 % interval", f"{compared.low:.2f} to {compared.high:.2f} ({compared.model})"],
        ]
    else:
        rows.append(["ratio of the loads", "needs a failure of each design"])
    return [*rows, ["log-rank test", f"p = {compared.log_rank:.2g}"]]


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
        ``designs.png`` in the folder.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> write_designs_figure.__name__
    'write_designs_figure'
    """
    with style.in_style(None):
        return style.save_figure(designs_figure(compared, first, second), folder / DESIGNS)
