"""Runs that were compared: the table of their pairs as CSV, and a page with text and figures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from markupsafe import Markup

from erlif.core.version import __version__
from erlif.io.conversion import table_csv
from erlif.io.files import write_file
from erlif.review.comparison import NO_CHANCE, describe_comparison
from erlif.show.report import layout

# Titles of the figures, by the names of their files.
FIGURES = {
    "films": "Films of the runs",
    "difference_map": "Difference map of two runs",
    "control_patch": "Control chart of the reference patch",
    "control_calibration": "Control chart of the calibrations",
}


def write_pair_table(found: xr.Dataset, output: Path) -> None:
    """Write the table of pairs as CSV.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.compare` returns it.
    output : Path

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
    write_file(output, table_csv(_columns(found)))


def write_comparison_page(found: xr.Dataset, output: Path, figures: Sequence[Path] = ()) -> None:
    """Write what was found as one page: sentences, figures, and the table of pairs.

    Parameters
    ----------
    found : xarray.Dataset
        As `erlif.compare` returns it.
    output : Path
    figures : sequence of Path
        As `erlif.show.plots.write_comparison_figures` returns them.

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
    ...     write_comparison_page(found, Path(directory) / "compare.html")
    ...     (Path(directory) / "compare.html").read_text("utf-8").count("<h2")
    2
    """
    *lines, conclusion = map(layout.print_units, describe_comparison(found))
    sections = [("result", "Result", _nested([conclusion, *lines]))]
    drawn = layout.arrange_figures(
        layout.embed_image(path, FIGURES[path.stem], wide=path.stem == "films") for path in figures
    )
    if drawn:
        sections.append(("figures", "Figures", drawn))
    page = layout.compose_page(
        [*sections, ("pairs", "Pairs", _table(_columns(found)))],
        name="Runs compared",
        subject="differences",
        subtitle=f"erlif {__version__}",
    )
    write_file(output, page)


def _nested(lines: Sequence[str]) -> Markup:
    """A list of lines, with those that are indented below the one before."""
    items: list[tuple[str, list[str]]] = []
    for line in lines:
        if line.startswith(" ") and items:
            items[-1][1].append(line.strip())
        else:
            items.append((line, []))
    return _list(Markup("{}{}").format(line, _list(below)) for line, below in items)


def _list(items: Iterable[str]) -> Markup:
    """Items of a list of HTML; nothing without one."""
    inner = Markup("").join(Markup("<li>{}</li>").format(item) for item in items)
    return Markup("<ul>{}</ul>").format(inner) if inner else inner


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


def _table(columns: dict[str, list[str]]) -> Markup:
    """The table of the page; a probability below those that are known is stated as such."""
    shown = columns | {
        name: ["below 1e-12" if float(each) < NO_CHANCE else each for each in columns[name]]
        for name in ("probability", "probability corrected")
    }
    for name in ("differs", "same calibration"):
        shown[name] = ["yes" if each == "1" else "no" for each in shown[name]]
    shown = {
        name: ["not known" if each == "nan" else each for each in values]
        for name, values in shown.items()
    }
    rows = list(zip(*shown.values(), strict=True))
    pairs = layout.PageTable(rows, tuple(shown), numbers=range(3, len(shown)))
    table = layout.render_part("macros.html", "scrolling", one=pairs, label="Table of the pairs")
    text = "Differences are the second run less the first; std is one standard deviation."
    return Markup("<p>{}</p>").format(text) + table
