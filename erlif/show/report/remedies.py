"""The shortest list of remedies for a target, as a table and in sentences."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.remedies import REMEDIES
from erlif.core.terms import SOURCES
from erlif.show.report.layout import print_columns


def print_remedies(table: xr.DataArray, which: str) -> str:
    """Write a list of remedies for the terminal, with what each leaves in nanometres.

    Parameters
    ----------
    table : xarray.DataArray
        From `erlif.planning.target.shortest_list`.
    which : str
        The film that decides, in words.

    Returns
    -------
    str

    Examples
    --------
    >>> table = xr.DataArray(
    ...     [[0.2, 0.1], [0.02, 0.01]],
    ...     {"remedy": ["", "walls"], "target_film": [1.0, 4.0]},
    ...     attrs={
    ...         "target": [0.01, 0.04], "within": 1.645, "gap": [0, 0], "largest": "size",
    ...         "largest_std": 0.01,
    ...     },
    ... )
    >>> print(print_remedies(table, "the median film of the run"))
    Target: nine of ten runs within 1 % of 4 um, the median film of the run.
    This is 40 nm, at a standard deviation of 24 nm.
    <BLANKLINE>
    standard deviation in nm        1 um  4 um
    as it is                         200   100
    1 State what the walls reflect    20    10
    <BLANKLINE>
    Reached at 4 um; not at 1 um.
    1 One measurement. As wall in [optics] of run.toml and fixture.toml. Leaves 0.5 %, the difference of parts of one finish.
    """  # noqa: E501
    attrs, remedies = table.attrs, [REMEDIES[key] for key in table["remedy"].values[1:]]
    films = [f"{film:.3g} um" for film in table.target_film.values]
    rows = [("standard deviation in nm", *films)]
    titles = ["as it is", *(f"{n} {remedy.what}" for n, remedy in enumerate(remedies, 1))]
    for title, std, gap in zip(titles, table.values, attrs["gap"], strict=True):
        cells = ("-" if np.isnan(one) else f"{1e3 * one:.0f}" for one in std)
        rows.append((title + " *" * gap, *cells))

    left, allowed = table.values[-1], np.array(attrs["target"]) / attrs["within"]
    within = dict(zip(films, (left <= allowed).tolist(), strict=True))
    met, missed = (", ".join(n for n in within if within[n] is each) for each in (True, False))
    columns = print_columns(rows, "<" + ">" * len(films))
    wanted = float(attrs["target"][-1])
    share = f"{100 * wanted / table.target_film.values[-1]:.2g} % of {films[-1]}, {which}"
    target = f"Target: {share}: {1e3 * wanted:.3g} nm"
    if attrs["within"] > 1:
        target = f"Target: nine of ten runs within {share}.\nThis is {1e3 * wanted:.3g} nm, at a "
        target += f"standard deviation of {1e3 * allowed[-1]:.2g} nm."
    lines = [target, "", columns, ""]
    lines.append(f"Reached at {met or 'no film'}{f'; not at {missed}' if met and missed else ''}.")
    if left[-1] > allowed[-1]:
        most = f"{SOURCES[attrs['largest']].what} ({1e3 * attrs['largest_std']:.0f} nm)"
        lines.append(f"No list reaches it: {1e3 * left[-1]:.0f} nm are left, most of it by {most}.")
    if any(attrs["gap"]):
        lines.append("* With what the gap takes out. A later fixture takes its place.")
    lines += [f"{n} {one.effort}. {one.why}" for n, one in enumerate(remedies, 1)]
    return "\n".join(lines)
