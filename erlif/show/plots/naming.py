"""Titles of figures, and text in place of a map without a valid pixel."""

from __future__ import annotations

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.figure import Figure, SubFigure

from erlif.core.arrays import Array, FlagImage
from erlif.core.flags import Flag
from erlif.io.files import settings_of

_LONGEST = 36  # letters of a name, so that run, load and oil fit into one column
_MOST = 3  # flags that are named for an empty map
_UNNAMED = "run"  # name of a run after its folder, which states nothing
_EVEN = 0.01  # relative range of a load that is written as one number


def run_line(film: xr.Dataset) -> str:
    """Write run, load and oil of a film in one line; nothing for what is not known.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> run_line(example_film())
    'example, 222 N, 0.12 Pa s'
    """
    if "settings" not in film.attrs:
        return ""
    settings = settings_of(film)
    oil, given = "", None if settings.joint is None else settings.joint.load
    if settings.oil is not None:
        viscosity = settings.oil.viscosity
        oil = settings.oil.name or ("" if viscosity is None else f"{viscosity:.3g} Pa s")

    # long names lose their ends, not the load
    name = "" if settings.name.lower() == _UNNAMED else settings.name
    parts = [_shorten(name), _describe_load(film, given), _shorten(oil)]
    return ", ".join(part for part in parts if part)


def _shorten(name: str) -> str:
    """Shorten a name at its end."""
    name = " ".join(name.split())
    return name if len(name) <= _LONGEST else f"{name[: _LONGEST - 1].rstrip()}…"


def _describe_load(film: xr.Dataset, given: float | None) -> str:
    """The load of the triggers, or the one of [joint]. [N]"""
    load = film["joint_load"].values if "joint_load" in film else np.array([])
    known = load[np.isfinite(load)]
    if known.size == 0:
        return "" if given is None else f"{given:.3g} N"
    low, high = float(known.min()), float(known.max())
    if high - low <= _EVEN * abs(high):
        return f"{known.mean():.3g} N"
    return f"{low:.3g} to {high:.3g} N"


def name_film(figure: Figure | SubFigure, film: xr.Dataset, more: str = "") -> None:
    """Write run, load and oil above a figure, and what else belongs to all its panels."""
    write_title(figure, "; ".join(part for part in (run_line(film), more) if part))


def write_title(figure: Figure | SubFigure, text: str) -> None:
    """Write the title of a figure; none in a style whose titles have no size, as of a journal."""
    if text and matplotlib.rcParams["figure.titlesize"] != 0:
        figure.suptitle(text, parse_math=False)  # a name may hold a dollar sign


def reason_empty(flags: FlagImage) -> str:
    """State which flags take the pixels of a map without a valid one, largest share first.

    Examples
    --------
    >>> reason_empty(np.full((4, 5), Flag.DIM, np.uint16))
    'no valid pixel: 100 % dim'
    """
    if flags.size == 0 or (flags == 0).any():
        return ""
    shares = [0.0, *(float(((flags & int(flag)) != 0).mean()) for flag in Flag)]
    return f"no valid pixel: {describe_shares(np.array(shares))}"


def describe_shares(shares: Array) -> str:
    """Write the largest shares of flags.

    Parameters
    ----------
    shares : array, (1 + flag,)
        Share of valid pixels, then of each flag, in the order of `erlif.core.flags.Flag`. [1]

    Returns
    -------
    str

    Examples
    --------
    >>> describe_shares(np.array([0.1, 0, 0.8, 0, 0.2, 0, 0, 0, 0, 0, 0]))
    '80 % dim, 20 % outside overlap'
    """
    named = sorted(zip(shares[1:], Flag, strict=True), key=lambda pair: -pair[0])
    return ", ".join(
        f"{100 * share:.0f} % {flag.title}" for share, flag in named[:_MOST] if share > 0
    )
