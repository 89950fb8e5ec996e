"""Endurance tests: load, torque, friction and temperature over time, and the onset of galling."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from erlif.core.arrays import Array
from erlif.endurance import EnduranceResult
from erlif.plots.style import (
    OUTWARD,
    RETURN,
    TWO_COLUMNS,
    AnyFigure,
    given_or_new,
    in_style,
    letter,
    new_figure,
    pt,
    rows_or_columns,
    save_figure,
    styled,
)

_MINUTE = 60.0
_ROW = 1.15  # inch, height of a panel
_LOADS = "#F0F0F0"  # behind the stages


@styled
def load_profile(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the load over time with the numbers of the stages. Farzaneh (2002), fig. 4-2.

    Parameters
    ----------
    result : EnduranceResult
        From `erlif.analyse_endurance`.
    ax : Axes, optional
        Default: those of a new figure, one column wide.

    Returns
    -------
    list of Artist

    Examples
    --------
    >>> from erlif.endurance.example import example_test
    >>> line, *_ = load_profile(example_test())
    >>> line.axes.get_ylabel()
    'load [kN]'
    """
    ax = given_or_new(ax)
    artists = _draw(result, result.test["load"].values / 1e3, ax, "load [kN]")
    for stage in result.loaded:
        middle = 0.5 * (stage.start + stage.end) / _MINUTE
        ax.annotate(
            str(stage.number),
            (middle, stage.load / 1e3),
            xytext=(0, pt(2)),
            textcoords="offset points",
            ha="center",
        )
    ax.margins(y=0.15)
    return artists


@styled
def friction_over_test(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the friction coefficient over time, with the onset of galling. Figs. 4-4, 4-6 and 4-7.

    Parameters
    ----------
    result, ax
        As for `load_profile`.

    Returns
    -------
    list of Artist

    Examples
    --------
    >>> from erlif.endurance.example import example_test
    >>> line, *_ = friction_over_test(example_test())
    >>> line.axes.get_ylabel()
    'friction coefficient'
    """
    ax = given_or_new(ax)
    return _draw(result, _in_stages(result, "friction"), ax, "friction coefficient")


@styled
def torque_over_test(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the torque over time, with the onset of galling. Figs. 4-3, 4-10 and 4-11.

    Parameters
    ----------
    result, ax
        As for `load_profile`.

    Returns
    -------
    list of Artist

    Examples
    --------
    >>> from erlif.endurance.example import example_test
    >>> line, *_ = torque_over_test(example_test())
    >>> line.axes.get_ylabel()
    'torque [N m]'
    """
    ax = given_or_new(ax)
    return _draw(result, result.test["torque"].values, ax, "torque [N m]")


@styled
def temperature_over_test(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the temperature of the pin over time. Figs. 4-5, 4-8 and 4-9.

    Parameters
    ----------
    result, ax
        As for `load_profile`.

    Returns
    -------
    list of Artist

    Examples
    --------
    >>> from erlif.endurance.example import example_test
    >>> line, *_ = temperature_over_test(example_test())
    >>> line.axes.get_ylabel()
    'temperature [°C]'
    """
    ax = given_or_new(ax)
    return _draw(result, result.test["temperature"].values, ax, "temperature [°C]")


@styled
def vibration_over_test(result: EnduranceResult, *, ax: Axes | None = None) -> list[Artist]:
    """Draw the level of vibration over time.

    Parameters
    ----------
    result, ax
        As for `load_profile`.

    Returns
    -------
    list of Artist

    Examples
    --------
    >>> from erlif.endurance.example import example_test
    >>> line, *_ = vibration_over_test(example_test())
    >>> line.axes.get_ylabel()
    'vibration'
    """
    ax = given_or_new(ax)
    return _draw(result, result.test["vibration"].values, ax, "vibration")


_PANELS = {
    "load": load_profile,
    "torque": torque_over_test,
    "friction": friction_over_test,
    "temperature": temperature_over_test,
    "vibration": vibration_over_test,
}


@styled
def endurance_figure(result: EnduranceResult, *, figure: AnyFigure | None = None) -> AnyFigure:
    """Draw all that a test has logged, one panel below the other. Figs. 4-3 and 4-10.

    Parameters
    ----------
    result
        As for `load_profile`.
    figure : Figure or SubFigure, optional
        An empty one to draw in; default: a new figure.

    Returns
    -------
    Figure
        Two columns wide.

    Examples
    --------
    >>> from erlif.endurance.example import example_test
    >>> len(endurance_figure(example_test()).axes)
    5
    """
    names = [name for name in _PANELS if name in result.test]
    figure = new_figure(TWO_COLUMNS, _ROW * len(names), text=0.4) if figure is None else figure
    figure.suptitle(result.name)
    panels = rows_or_columns(figure, len(names), sharex=True)
    for ax, name, mark in zip(panels, names, "abcde", strict=False):
        _PANELS[name](result, ax=ax)
        letter(ax, mark)
        if ax is not panels[-1]:
            ax.set_xlabel("")
    return figure


def write_endurance_figures(result: EnduranceResult, folder: Path) -> list[Path]:
    """Write the figures of a test.

    Parameters
    ----------
    result : EnduranceResult
    folder : Path

    Returns
    -------
    list of Path

    Raises
    ------
    OutputError
        If they cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from erlif.endurance.example import example_test
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     [path.name for path in write_endurance_figures(example_test(), Path(directory))]
    ['example.png']
    """
    with in_style(None):
        return [save_figure(endurance_figure(result), folder / f"{result.name}.png")]


def _in_stages(result: EnduranceResult, name: str) -> Array:
    """A column within the stages, NaN between them."""
    kept = np.full(result.test.sizes["time"], np.nan)
    for stage in result.loaded:
        kept[stage.samples] = result.test[name].values[stage.samples]
    return kept


def _draw(result: EnduranceResult, values: Array, ax: Axes, label: str) -> list[Artist]:
    """A line over the time of the test, the stages shaded, the onset marked."""
    time = result.test["time"].values / _MINUTE
    artists: list[Artist] = []
    artists += ax.plot(time, values, color=OUTWARD, linewidth=pt(0.7))
    for stage in result.loaded:
        ax.axvspan(stage.start / _MINUTE, stage.end / _MINUTE, color=_LOADS, linewidth=0, zorder=0)
    if result.onset is not None:
        onset = result.onset
        ax.axvspan(
            onset.earliest / _MINUTE, onset.latest / _MINUTE, color=RETURN, alpha=0.3, linewidth=0
        )
        artists.append(ax.axvline(onset.time / _MINUTE, color=RETURN, linewidth=pt(0.8)))
    ax.set(xlim=(time[0], time[-1]), xlabel="time [min]", ylabel=label)
    return artists
