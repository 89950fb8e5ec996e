"""A budget of the uncertainty as a table for the terminal."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.units import count_of
from erlif.show.report.layout import print_columns
from erlif.show.report.remedies import print_remedies


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
