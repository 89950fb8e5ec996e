"""The uncertainty budget as a table."""

from __future__ import annotations

import numpy as np
import xarray as xr

from erlif.core.units import count_of


def render_budget(budget: xr.Dataset) -> str:
    """Write a budget as a table in Markdown, in nanometres.

    Parameters
    ----------
    budget : xarray.Dataset
        From `erlif.budget`: std (term, quantity) [um], kind (term), value (quantity) [um].

    Returns
    -------
    str
        One row a term; the sums are bold.

    Examples
    --------
    A single term of 12.3 nm, and a total that is the same:

    >>> budget = xr.Dataset(
    ...     {
    ...         "std": (("term", "quantity"), [[0.0123], [0.0123]]),
    ...         "kind": ("term", ["random", "sum"]),
    ...         "value": ("quantity", [5.0]),
    ...     },
    ...     {"term": ["photons", "total"], "quantity": ["mean"]},
    ...     {"run": "example", "trigger": 2, "frames": 1},
    ... )
    >>> print(render_budget(budget), end="")
    Standard deviations in nm: example, trigger 2, 1 frame pair.
    <BLANKLINE>
    | term | mean | kind |
    |---|---:|---|
    | film thickness [um] | 5.00 | |
    | photons | 12 | random |
    | **total** | **12** |  |
    """
    titles = [str(title) for title in budget.quantity.values]
    count = count_of(int(budget.attrs["frames"]), "frame pair")
    place = f"{budget.attrs['run']}, trigger {budget.attrs['trigger']}, {count}"
    lines = [
        f"Standard deviations in nm: {place}.",
        "",
        f"| term | {' | '.join(titles)} | kind |",
        f"|---|{'---:|' * len(titles)}---|",
        f"| film thickness [um] | {' | '.join(f'{v:.2f}' for v in budget['value'].values)} | |",
    ]

    # sums stand out among their terms
    rows = zip(budget.term.values, budget["std"].values, budget.kind.values, strict=True)
    for term, row, kind in rows:
        cells = [_in_nanometres(value) for value in row]
        if kind == "sum":
            term, kind, cells = f"**{term}**", "", [f"**{cell}**" for cell in cells]
        lines.append(f"| {term} | {' | '.join(cells)} | {kind} |")
    return "\n".join(lines) + "\n"


def _in_nanometres(value: float) -> str:
    """Write a value [um] in nm with two digits at least; a dash where the term does not enter."""
    if np.isnan(value):
        return "-"
    nanometres = 1000 * value
    return f"{nanometres:.1f}" if nanometres < 10 else f"{nanometres:.0f}"
