"""The report of many runs: one table, one figure of all, and a map of each."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np
import xarray as xr

from erlif.core.errors import ErlifError
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.version import __version__
from erlif.io.files import (
    describe_trigger,
    fastest_trigger,
    flag_shares,
    label_films,
    open_film,
    reading_film,
    refuse_existing,
    refuse_repeated,
    replacing,
    settings_of,
)
from erlif.review.comparison import compare
from erlif.show.plots.comparison import comparison_figure
from erlif.show.plots.maps import common_limits, thickness_map
from erlif.show.plots.style import in_style
from erlif.show.report.captions import Caption
from erlif.show.report.download import download_link, runs_csv
from erlif.show.report.layout import PageFigure, arrange_figures, compose_page, embed_figure
from erlif.show.report.page import MAX_SIZE, check_size
from erlif.show.report.tables import make_table, with_error, with_span

_PER_MB = 1e6  # bytes
_FRAME = 40_000  # bytes of style and headings
_MOST_COMPARED = 12  # runs whose pairs a figure still shows
_COMPARED = Caption(
    "Runs compared",
    "Minimum film thickness against the duty parameter, where speed and load are known, and the "
    "differences of all pairs, second run less first. erlif compare states which differ.",
)
_HEAD = (
    *("Run", "Load [N]", "Oil", "Speed [mm/s]", "Thinnest film of the run [µm]"),
    *("Mean film at the fastest trigger [µm]", "Power of speed over load"),
    *("Valid pixels", "Triggers", "Warnings"),
)


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
    out_path : path
        The page.
    max_size : float
        Largest size of the page; maps of the last runs are left out beyond it. [MB]
    overwrite : bool
        Replace an existing page.
    progress : "bar", bool or callable, optional
        As for `erlif.process`.

    Returns
    -------
    Path
        `out_path`.

    Raises
    ------
    OutputError
        If the page exists or cannot be written, or there is no such film.
    ErlifError
        If the size is too small for a page.

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
    refuse_existing(out_path, overwrite=overwrite)
    paths = [Path(path) for path in film_paths]
    refuse_repeated(paths)
    rows, numbers, limits = [], [], []
    for done, path in enumerate(paths):
        with reading_film(path), open_film(path) as film:
            cells, values = _describe_run(film)
            limits.append(common_limits(film, [fastest_trigger(film)]))
        rows.append(cells)
        numbers.append(values)
        report("films", done + 1, len(paths))

    labels = label_films([values["run"] for values in numbers], paths)
    for cells, values, label in zip(rows, numbers, labels, strict=True):
        cells[0], values["run"] = escape(label), label

    link = download_link(runs_csv(numbers), name="runs.csv", label="Save as CSV")
    table = make_table(rows, head=_HEAD, numbers=[1, 3, 4, 5, 6, 7, 8, 9])
    look = 'class="wide dense" tabindex="0" role="region" aria-label="Table of the runs"'
    compared = _compare_runs(paths)
    room = max_size * _PER_MB - _FRAME - len((table + link + compared).encode())
    ends = (min(low for low, _ in limits), max(high for _, high in limits))
    text = compose_page(
        [
            ("runs", "Runs", f"<p>{link}</p><div {look}>{table}</div>"),
            ("compared", "Comparison", compared),
            (
                "maps",
                "Maps at the fastest trigger",
                _map_section(paths, labels, ends, room, report),
            ),
        ],
        name=f"{len(paths)} runs",
        subject="oil-film thickness",
        subtitle=f"Oil-film thickness from two-camera fluorescence, erlif {__version__}; "
        "± is one standard deviation, random and shared",
    )
    with replacing(out_path) as scratch:
        scratch.write_text(text, encoding="utf-8")
    return out_path


def _describe_run(film: xr.Dataset) -> tuple[list[str], dict[str, str]]:
    """Cells of the table, as HTML, and the same numbers with more digits."""
    settings, fastest = settings_of(film), fastest_trigger(film)
    least, mean = film.film_min.values, film.film_mean.values
    thinnest = int(np.nanargmin(least)) if np.isfinite(least).any() else 0
    valid = float(flag_shares(film)[:, 0].mean())
    notes = dict.fromkeys(str(film.attrs.get("notes", "")).split("\n"))
    warnings = sum(note.startswith("warning: ") for note in notes)
    oil = "" if settings.oil is None else settings.oil.name or ""
    load = film["load"].values if "load" in film else np.array([np.nan])
    speed = 1e3 * np.abs(film.sliding_speed.values) if "sliding_speed" in film else [np.nan]
    power, power_std = (
        float(film[name]) if name in film else math.nan
        for name in ("speed_exponent", "speed_exponent_std")
    )
    films = [
        (float(least[thinnest]), float(film.film_min_std[thinnest])),
        (float(mean[fastest]), float(film.film_mean_std[fastest])),
    ]
    triggers = film.sizes["trigger"]
    cells = [
        *(escape(settings.name), with_span(load), _unbroken(oil), with_span(np.asarray(speed))),
        *(with_error(value, std) for value, std in (*films, (power, power_std))),
        *(f"{100 * valid:.1f} %", f"{triggers}", f"{warnings}"),
    ]
    known = {
        "load [N]": np.asarray(load),
        "speed [mm/s]": np.asarray(speed),
    }
    values = {"run": settings.name, "oil": oil}
    for name, each in known.items():
        finite = each[np.isfinite(each)]
        for end, pick in (("lowest", np.min), ("highest", np.max)):
            values[f"{end} {name}"] = f"{pick(finite):.9g}" if finite.size else "NaN"
    titles = ("film_min [um]", "film_min_std [um]", "film_mean [um]", "film_mean_std [um]")
    for title, number in zip(titles, (*films[0], *films[1]), strict=True):
        values[title] = f"{number:.9g}".replace("nan", "NaN")
    for title, number in (("speed_exponent [1]", power), ("speed_exponent_std [1]", power_std)):
        values[title] = f"{number:.9g}".replace("nan", "NaN")
    values |= {"valid share [1]": f"{valid:.9g}", "triggers": f"{triggers}"}
    return cells, values | {"warnings": f"{warnings}"}


def _unbroken(text: str) -> str:
    """HTML of a short name that stays in one line."""
    return f'<span style="white-space:nowrap">{escape(text)}</span>'


def _compare_runs(paths: list[Path]) -> str:
    """The figure of all runs, or the reason why there is none."""
    if len(paths) > _MOST_COMPARED:
        return (
            f"<p>The figure shows at most {_MOST_COMPARED} runs; <code>erlif compare</code> "
            "compares all.</p>"
        )
    try:
        found = compare(list(paths))
    except ErlifError as error:
        return f"<p>The runs are not compared: {escape(str(error))}</p>"
    with in_style(None):
        figure = comparison_figure(found)
        return arrange_figures([embed_figure("compared", figure, _COMPARED, _COMPARED.text)])


def _map_section(
    paths: list[Path],
    labels: list[str],
    limits: tuple[float, float],
    room: float,
    progress: Progress,
) -> str:
    """Maps of the runs on one colour scale, as many as there is room for."""
    parts: list[PageFigure] = []
    for done, path in enumerate(paths):
        with reading_film(path), open_film(path) as film:
            part = _draw_map(film, labels[done], done, limits)
        room -= len((part.image + part.caption).encode())
        if room < 0:
            left = len(paths) - done
            note = (
                f"<p>Maps of the last {left} of {len(paths)} runs are left out for the size of the "
                "page; <code>--max-size</code> allows a larger one, <code>erlif report FILM</code> "
                "makes a page of one run.</p>"
            )
            progress("maps", len(paths), len(paths))
            return note + arrange_figures(parts)
        parts.append(part)
        progress("maps", done + 1, len(paths))
    return arrange_figures(parts)


def _draw_map(film: xr.Dataset, label: str, number: int, limits: tuple[float, float]) -> PageFigure:
    """The map of a run at its fastest trigger."""
    trigger = fastest_trigger(film)
    caption = Caption(label, "", "png", 110)
    with in_style(None):
        image = thickness_map(film, trigger=trigger, limits=limits)
        figure = image.axes.figure
        text = f"{describe_trigger(film, trigger).capitalize()}."
        return embed_figure(f"run-{number + 1}", figure, caption, text)
