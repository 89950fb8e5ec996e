"""The table of the triggers as a file that the page itself holds."""

from __future__ import annotations

import base64
import csv
import io
import re
from collections.abc import Sequence
from html import escape

import numpy as np
import xarray as xr

from erlif.core.arrays import AnyArray, Array
from erlif.io.conversion import trigger_columns

_LONGEST = 80  # characters of the name of a run in the name of a file


def trigger_csv(film: xr.Dataset, valid: Array, triggers: AnyArray) -> str:
    """Write the numbers of triggers as CSV, one row for each.

    Parameters
    ----------
    film : xarray.Dataset
        As `erlif.open_film` returns it.
    valid : array, (trigger,)
        Share of valid pixels. [1]
    triggers : array of int
        The rows.

    Returns
    -------
    str
        Names with units in the first row; numbers with nine digits, or NaN.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> text = trigger_csv(example_film(), np.full(6, 0.5), np.arange(6))
    >>> text.splitlines()[0][:38]
    'trigger,frames_used [1],film_mean [um]'
    """
    # covariances and other numbers with further dims are left to erlif export
    columns = [
        each
        for each in trigger_columns(film)
        if each.name in film.variables and each.values.dtype.kind in "iufb"
    ]
    table = [[_digits(value) for value in each.values[triggers].tolist()] for each in columns]
    table.append([_digits(value) for value in valid[triggers].tolist()])
    file = io.StringIO()
    writer = csv.writer(file)
    writer.writerow([*(each.heading for each in columns), "valid share [1]"])
    writer.writerows(zip(*table, strict=True))
    return file.getvalue()


def _digits(value: float) -> str:
    """A number with the digits that single precision holds."""
    return "NaN" if np.isnan(value) else f"{value:.9g}"


def runs_csv(runs: Sequence[dict[str, str]]) -> str:
    """Write the numbers of runs as CSV, one row for each.

    Parameters
    ----------
    runs : sequence of dict
        Cells by the heading of their column.

    Returns
    -------
    str

    Examples
    --------
    >>> runs_csv([{"run": "a", "load [N]": "222"}]).splitlines()
    ['run,load [N]', 'a,222']
    """
    file = io.StringIO()
    writer = csv.DictWriter(file, list(runs[0]))
    writer.writeheader()
    writer.writerows(runs)
    return file.getvalue()


def download_link(text: str, *, name: str, label: str) -> str:
    """Make a link by which a browser saves a text.

    Parameters
    ----------
    text : str
        Content of the file, CSV.
    name : str
        Name of the file.
    label : str
        Text of the link.

    Returns
    -------
    str
        HTML.

    Examples
    --------
    >>> download_link("a", name="a.csv", label="Save")
    '<a download="a.csv" href="data:text/csv;charset=utf-8;base64,YQ==">Save</a>'
    """
    content = base64.b64encode(text.encode()).decode("ascii")
    address = f"data:text/csv;charset=utf-8;base64,{content}"
    return f'<a download="{escape(name)}" href="{address}">{escape(label)}</a>'


def file_name(run: str, suffix: str) -> str:
    """Make the name of a file from that of a run.

    Parameters
    ----------
    run : str
        Name of the run.
    suffix : str
        End of the name.

    Returns
    -------
    str
        Letters, digits, points and hyphens of the run, joined by underscores.

    Examples
    --------
    >>> file_name("straight bushing <1>", "triggers.csv")
    'straight_bushing_1_triggers.csv'
    """
    words = re.findall(r"[\w.-]+", run)
    return "_".join([*filter(None, ["_".join(words)[:_LONGEST].strip("._-")]), suffix])
