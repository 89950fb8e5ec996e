"""The report of many runs: one table, one figure of all, and a map of each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup

from erlif.core.errors import ErlifError
from erlif.core.notes import Level, split_notes
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.version import __version__
from erlif.io import files
from erlif.io.conversion import table_csv
from erlif.review.comparison import compare
from erlif.show.plots.comparison import comparison_figure
from erlif.show.plots.maps import common_limits, thickness_map
from erlif.show.plots.style import in_style
from erlif.show.report import layout
from erlif.show.report.captions import CAPTIONS, Caption
from erlif.show.report.page import MAX_SIZE, check_size
from erlif.show.report.tables import with_error, with_span

_PER_MB = 1e6  # bytes
_FRAME = 40_000  # bytes of style and headings
_MOST_COMPARED = 12  # runs whose pairs a figure still shows


def write_runs_report(
    film_paths: Sequence[str | Path],
    out_path: str | Path,
    *,
    max_size: float = MAX_SIZE,
    overwrite: bool = False,
    progress: ShowProgress = None,
) -> Path:
    """Write one self-contained HTML page about several films beside each other.

    The page holds a table of all runs, their comparison in a figure, and the map of each run at its
    fastest trigger, all on one colour scale.

    Parameters
    ----------
    film_paths : sequence of path
        Films, in the order of the table.
    max_size : float
        Largest size of the page; maps of the last runs are left out beyond it. [MB]
    out_path, overwrite, progress
        As for `erlif.show.report.write_report`, as what is returned and raised.

    Returns
    -------
    Path
        `out_path`, as of `write_report`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import write_example
    >>> with TemporaryDirectory() as directory:
    ...     films = [write_example(f"{directory}/{name}.nc") for name in "ab"]
    ...     page = write_runs_report(films, f"{directory}/report.html").read_text("utf-8")
    >>> page.count("<figure "), page.count("<h2")
    (3, 3)
    """
    report = choose_progress(progress)
    check_size(max_size)
    out_path = Path(out_path)
    files.refuse_existing(out_path, overwrite=overwrite)
    files.expect_folder(out_path)
    # the numbers of all runs come first: one colour scale for all maps needs their limits
    paths = [Path(path) for path in film_paths]
    files.refuse_repeated(paths)
    rows, numbers, limits = [], [], []
    for done, path in enumerate(paths):
        with files.reading_film(path), files.open_film(path) as film:
            cells, values = _describe_run(film)
            limits.append(common_limits(film, [files.fastest_trigger(film)]))
        rows.append(cells)
        numbers.append(values)
        report("films", done + 1, len(paths))

    labels = files.label_films([values["run"] for values in numbers], paths)
    for cells, values, label in zip(rows, numbers, labels, strict=True):
        cells[0] = values["run"] = label

    columns = {name: [values[name] for values in numbers] for name in numbers[0]}
    table = layout.render(
        "runs.html",
        runs=layout.PageTable(rows, layout.TABLES["columns"]["runs"], numbers=(1, *range(3, 10))),
        link=layout.download_link(table_csv(columns, digits=9, missing="NaN"), name="runs.csv"),
    )
    compared = _compare_runs(paths)
    room = max_size * _PER_MB - _FRAME - len((table + compared).encode())
    # maps take the room that table and figure leave
    ends = (min(low for low, _ in limits), max(high for _, high in limits))
    maps = _map_section(paths, labels, ends, room, report)
    sections = [("runs", "Runs", table), ("compared", "Comparison", compared)]
    text = layout.compose_page(
        [*sections, ("maps", "Maps at the fastest trigger", maps)],
        name=f"{len(paths)} runs",
        subject="oil-film thickness",
        subtitle=f"Oil-film thickness from two-camera fluorescence, erlif {__version__}; "
        "± is one standard deviation, random and shared",
    )
    return files.write_file(out_path, text)


def _describe_run(film: xr.Dataset) -> tuple[list[str], dict[str, Any]]:
    """Cells of the table, and the same numbers with more digits."""
    settings, fastest = files.settings_of(film), files.fastest_trigger(film)
    oil = "" if settings.oil is None else settings.oil.name or ""
    unknown = np.array([np.nan])
    load = film["joint_load"].values if "joint_load" in film else unknown
    speed = 1e3 * np.abs(film.sliding_speed.values) if "sliding_speed" in film else unknown
    values: dict[str, Any] = {"run": settings.name, "oil": oil}
    for name, each in (("load [N]", load), ("speed [mm/s]", speed)):
        values[f"lowest {name}"] = np.fmin.reduce(each)
        values[f"highest {name}"] = np.fmax.reduce(each)

    # the thinnest film of the run, the mean one at the fastest trigger, and the power
    least = film.film_min.values
    thinnest = int(np.nanargmin(least)) if np.isfinite(least).any() else 0
    shown = []
    for name, trigger in (("film_min", thinnest), ("film_mean", fastest)):
        pair = float(film[name][trigger]), float(film[f"{name}_std"][trigger])
        values |= {f"{name} [um]": pair[0], f"{name}_std [um]": pair[1]}
        shown.append(with_error(*pair))
    names = ("speed_exponent", "speed_exponent_std")
    power, std = (float(film[name]) if name in film else math.nan for name in names)
    values |= {f"{name} [1]": value for name, value in zip(names, (power, std), strict=True)}

    valid, triggers = float(files.flag_shares(film)[:, 0].mean()), film.sizes["trigger"]
    notes = set(split_notes(str(film.attrs.get("notes", ""))))
    warnings = sum(level is Level.WARNING for level, _ in notes)
    values |= {"valid share [1]": valid, "triggers": triggers, "warnings": warnings}
    unbroken = Markup('<span style="white-space:nowrap">{}</span>').format(oil)
    motion = with_span(load), unbroken, with_span(speed)
    counts = f"{100 * valid:.1f} %", f"{triggers}", f"{warnings}"
    return [settings.name, *motion, *shown, with_error(power, std), *counts], values


def _compare_runs(paths: list[Path]) -> Markup:
    """The figure of all runs, or the reason why there is none."""
    if len(paths) > _MOST_COMPARED:
        return Markup(
            f"<p>The figure shows at most {_MOST_COMPARED} runs; <code>erlif compare</code> "
            "compares all.</p>"
        )
    try:
        comparison = compare(list(paths))
    except ErlifError as error:
        return Markup("<p>The runs are not compared: {}</p>").format(error)
    with in_style(None):
        figure = comparison_figure(comparison)
        part = layout.embed_figure("compared", figure, CAPTIONS["compared"])
    return layout.arrange_figures([part])


def _map_section(
    paths: list[Path],
    labels: list[str],
    limits: tuple[float, float],
    room: float,
    progress: Progress,
) -> Markup:
    """Maps of the runs on one colour scale, as many as there is room for."""
    parts: list[layout.PageFigure] = []
    for done, path in enumerate(paths):
        with files.reading_film(path), files.open_film(path) as film, in_style(None):
            trigger = files.fastest_trigger(film)
            image = thickness_map(film, trigger=trigger, limits=limits)
            text = f"{files.describe_trigger(film, trigger).capitalize()}."
            caption = Caption(labels[done], text, "png", 110)
            part = layout.embed_figure(f"run-{done + 1}", image.axes.figure, caption)
        room -= len((part.source + part.text).encode())
        if room < 0:
            left = len(paths) - done
            note = Markup(
                f"<p>Maps of the last {left} of {len(paths)} runs are left out for the size of the "
                "page; <code>--max-size</code> allows a larger one, <code>erlif report FILM</code> "
                "makes a page of one run.</p>"
            )
            progress("maps", len(paths), len(paths))
            return note + layout.arrange_figures(parts)
        parts.append(part)
        progress("maps", done + 1, len(paths))
    return layout.arrange_figures(parts)
