"""The table of the pairs of runs that were compared, as CSV and as a page."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from markupsafe import Markup

from erlif.core.version import __version__
from erlif.io.conversion import table_csv
from erlif.io.files import write_file
from erlif.review.comparison import NO_CHANCE
from erlif.show.report.layout import Table, compose_page, render_part


def write_pair_table(found: xr.Dataset, output: Path) -> None:
    """Write the table of pairs, as CSV or as HTML by the suffix.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.compare` returns it.
    output : Path
        File in .csv or .html.

    Raises
    ------
    OutputError
        If it cannot be written.

    Examples
    --------
    >>> import erlif
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_film
    >>> film = example_film()
    >>> found = erlif.compare([film, film.assign(film_min=film.film_min + 0.5)])
    >>> with TemporaryDirectory() as directory:
    ...     write_pair_table(found, Path(directory) / "compare.csv")
    ...     (Path(directory) / "compare.csv").read_text().splitlines()[1][:40]
    'example (1),example (2),film_min,0.5000,'
    """
    columns = _columns(found)
    write_file(output, _page(columns) if output.suffix == ".html" else table_csv(columns))


def _columns(found: xr.Dataset) -> dict[str, list[str]]:
    """Text of the columns, a row for each pair and statistic."""
    pairs = found.stack(row=("pair", "statistic"), create_index=False)

    def numbers(name: str, form: str) -> list[str]:
        return [format(value, form) for value in pairs[name].values.tolist()]

    # it is known for each pair and stands in the row of each statistic
    same = np.broadcast_to(pairs.same_calibration, pairs.differs.shape)
    return {
        **{name: pairs[name].values.tolist() for name in ("first", "second", "statistic")},
        "difference [um]": numbers("difference", ".4f"),
        "std [um]": numbers("difference_std", ".4f"),
        "probability": numbers("probability", ".3g"),
        "probability corrected": numbers("probability_corrected", ".3g"),
        "differs": numbers("differs", "d"),
        "same calibration": [str(each) for each in same.tolist()],
    }


def _page(columns: dict[str, list[str]]) -> str:
    """The table as a page; a probability below those that are known is stated as such."""
    shown = columns | {
        name: ["below 1e-12" if float(each) < NO_CHANCE else each for each in columns[name]]
        for name in ("probability", "probability corrected")
    }
    rows = list(zip(*shown.values(), strict=True))
    pairs = Table(rows, tuple(shown), numbers=range(3, len(shown)))
    table = render_part("macros.html", "scrolling", one=pairs, label="Table of the pairs")
    said = "Differences are the second run less the first; std is one standard deviation."
    return compose_page(
        [("pairs", "Pairs", Markup("<p>{}</p>").format(said) + table)],
        name="Runs compared",
        subject="differences",
        subtitle=f"erlif {__version__}",
    )
