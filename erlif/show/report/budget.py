"""A budget of the uncertainty, and the shortest list of remedies for a target, as tables."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.remedies import REMEDIES
from erlif.core.terms import SOURCES
from erlif.core.units import count_of
from erlif.show.report.layout import print_columns


def print_budget(budget: xr.Dataset) -> str:
    """Write a budget as a table for the terminal, in nanometres, by kinds of error.

    Parameters
    ----------
    budget : xarray.Dataset
        From `erlif.budget`: std (term, quantity) [um], kind (term), value (quantity) [um].

    Returns
    -------
    str
        One row a term; the sum of a kind stands below its terms.

    Examples
    --------
    >>> budget = xr.Dataset(
    ...     {
    ...         "std": (("term", "quantity"), [[0.0123], [0.0123]]),
    ...         "kind": ("term", ["random", "sum"]),
    ...         "value": ("quantity", [5.0]),
    ...     },
    ...     {"term": ["photons", "total"], "quantity": ["mean film"]},
    ...     {"run": "example", "trigger": 2, "frames": 1},
    ... )
    >>> print(print_budget(budget))
    Standard deviations in nm: example, trigger 2, 1 frame pair
    <BLANKLINE>
    term                 mean
    film thickness [um]  5.00
    random
      photons              12
    total                  12
    """
    attrs, titles = budget.attrs, [str(title) for title in budget.quantity.values]
    short = [title.removeprefix("pixel of ").removesuffix(" film") for title in titles]
    films = (f"{value:.2f}" for value in budget["value"].values)
    rows, last = [("term", *short), ("film thickness [um]", *films)], ""
    columns = budget.term.values, budget["std"].values, budget.kind.values
    for term, stds, kind in zip(*columns, strict=True):
        if kind not in (last, "sum"):
            rows.append((str(kind), *[""] * len(titles)))
        last = kind
        rows.append((f"{'' if kind == 'sum' else '  '}{term}", *map(_in_nanometres, stds)))
    below = ["", "Columns with a film in um: a single pixel of this film."]
    pixels = any(title.startswith("pixel of ") for title in titles)
    count = count_of(int(attrs["frames"]), "frame pair")
    head = f"Standard deviations in nm: {attrs['run']}, trigger {attrs['trigger']}, {count}"
    table = print_columns(rows, "<" + ">" * len(titles))
    lines = [head, "", table, *(below if pixels else [])]
    if zero := attrs.get("declared_zero"):
        lines += ["", f"Declared to be 0 % in [systematics]: {', '.join(zero)}."]
    if "target_std" in budget:
        lines += ["", print_remedies(budget.target_std, "the median film of the run")]
    return "\n".join(lines)


def _in_nanometres(value: float) -> str:
    """Write a value [um] in nm with two digits at least; a dash where the term does not enter."""
    if np.isnan(value):
        return "-"
    nanometres = 1000 * value
    return f"{nanometres:.1f}" if nanometres < 10 else f"{nanometres:.0f}"


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
