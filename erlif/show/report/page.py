"""The report: one HTML page about a film that needs no other file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import xarray as xr
from markupsafe import Markup

from erlif.calibration import calibration_of
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.core.notes import Level, split_notes
from erlif.core.progress import Progress, ShowProgress, choose_progress, silent
from erlif.core.version import __version__
from erlif.io import files
from erlif.show.plots.files import DRAWN, FigureSource, figures_of, find_source, reason_missing
from erlif.show.plots.prediction import has_prediction, predicted_map
from erlif.show.plots.style import in_style
from erlif.show.report import layout, tables
from erlif.show.report.captions import caption_of
from erlif.show.report.maps import KeptMaps, choose_maps, embed_map
from erlif.show.report.summary import describe_briefly
from erlif.show.report.viewer import viewer_page, viewer_section

# Largest size of a page, where none is given. [MB]
MAX_SIZE = 10.0

_PER_MB = 1e6  # bytes
_LEAST_SIZE = 0.5  # MB
_FIGURES = 0.6  # of the page, for figures at most
_TABLE = 0.2  # of the page, for the file of the triggers; as base64 it is a third longer
_FRAME = 30_000  # bytes of style, palettes and texts
_LESS = 0.97  # of the room that was exceeded, in another attempt
# figures of the result, before those of the method
_FIRST = (
    *("film_over_cycle", "thickness_map", "film_against_speed", "film_and_prediction"),
    *("film_along_axis", "prediction_map", "pin_orbit", "stribeck", "map_sheet"),
    "map_sheet_less_gap",
)
_OF_IMAGES = ("processed_images", "ratio_image")
_OF_ONE_TRIGGER = (*_OF_IMAGES, "thickness_map", "film_along_axis", "prediction_map")


@files.takes(film_path="film file", out_path="path")
def write_report(
    film_path: str | Path,
    out_path: str | Path,
    *,
    run_dir: str | Path | None = None,
    fixture_dir: str | Path | None = None,
    triggers: tuple[int, int] | None = None,
    max_size: float = MAX_SIZE,
    overwrite: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> Path:
    """Write one self-contained HTML page about a film.

    The page holds a summary, a viewer of all maps, the figures, a table of the triggers, settings
    and input hashes. It loads nothing from the network and works when opened from a file. Where all
    maps would make it larger than `max_size`, it holds fewer triggers and pixels, and states which
    beside the viewer.

    Parameters
    ----------
    film_path : path
        ``film.nc`` or ``film.zarr``.
    out_path : path
        The page.
    run_dir, fixture_dir : path, optional
        As for `erlif.show.plots.write_figures`.
    triggers : (int, int), optional
        First and last trigger whose maps the page holds; default: all.
    max_size : float
        Largest size of the page. [MB]
    overwrite : bool
        Replace an existing page.
    allow_outside : bool
        Follow links and names of files that leave the run directory.
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
        If the film has no such triggers, or the size is too small for a page.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import write_example
    >>> with TemporaryDirectory() as directory:
    ...     film_path = write_example(f"{directory}/film.nc")
    ...     page = write_report(film_path, f"{directory}/report.html").read_text("utf-8")
    >>> page[:15], page.count("<h2")
    ('<!DOCTYPE html>', 6)
    """
    report = choose_progress(progress)
    check_size(max_size)
    out_path = Path(out_path)
    files.refuse_existing(out_path, overwrite=overwrite)
    with files.reading_film(film_path), files.open_film(film_path) as film:
        files.expect_folder(out_path)
        chosen = _check_range(film, triggers)
        opening = chosen[files.fastest_trigger(film.isel(trigger=slice(chosen[0], chosen[-1] + 1)))]
        source = find_source(
            film_path, film, opening, run_dir, fixture_dir, allow_outside=allow_outside
        )
        text = _make_page(source, chosen, max_size, report)
    return files.write_file(out_path, text)


def check_size(max_size: float) -> None:
    """Refuse a size that is too small for a page, in MB."""
    if not max_size >= _LEAST_SIZE:
        raise ErlifError(
            f"Expected a page of {_LEAST_SIZE:g} MB or more; got {max_size:g} MB. Give a larger "
            "size with --max-size."
        )


def _check_range(film: xr.Dataset, triggers: tuple[int, int] | None) -> range:
    """The triggers of the maps."""
    count = film.sizes["trigger"]
    first, last = (0, count - 1) if triggers is None else triggers
    if not 0 <= first <= last < count:
        raise ErlifError(
            f"Expected triggers from 0 to {count - 1}, the first before the last; got "
            f"{first}-{last}. Choose them with --trigger."
        )
    return range(first, last + 1)


def _make_page(source: FigureSource, triggers: range, max_size: float, progress: Progress) -> str:
    """Compose the sections, the embedded maps, the style and the script."""
    film, limit = source.film, _PER_MB * max_size
    shares = files.flag_shares(film)
    summary = _summary_section(film, shares)
    numbers = _numbers_section(source, shares)
    figures = figures_section(source, progress, room=_FIGURES * limit)
    table = tables.trigger_section(film, shares[:, 0], most=_TABLE * limit)
    provenance = provenance_section(film)

    # what is left belongs to the maps; their size is measured, and fewer are kept if it is large
    others = [summary, figures, numbers, table, provenance, viewer_page()]
    room = allowed = limit - sum(len(text.encode()) for text in others) - _FRAME
    thickest, opening = calibration_of(film).thickness_range[1], source.trigger
    while True:
        kept = choose_maps(film, room=room, thickest=thickest, opening=opening, triggers=triggers)
        embedded = _embedded_maps(film, kept, progress)
        if len(embedded) <= allowed or len(kept.triggers) == 1:
            break
        room *= _LESS * allowed / len(embedded)

    sections = [
        ("summary", "Film", summary),
        ("viewer", "Film maps", viewer_section(film, kept, embedded, limit=max_size)),
        ("figures", "Figures", figures),
        ("numbers", "Numbers and notes", numbers),
        ("triggers", "Triggers", table),
        ("provenance", "Settings and inputs", provenance),
    ]
    # nothing of the time or the place of the report enters: the same film gives the same page
    version = str(film.attrs.get("erlif_version", __version__))
    return layout.compose_page(
        sections,
        name=files.settings_of(film).name,
        subject="oil-film thickness",
        subtitle=f"Oil-film thickness from two-camera fluorescence, erlif {version}",
    )


def _embedded_maps(film: xr.Dataset, kept: KeptMaps, progress: Progress) -> Markup:
    """Write every kept map as text in a script element of its own."""
    scripts = []
    for done, trigger in enumerate(kept.triggers):
        predicted = predicted_map(film, trigger=trigger) if has_prediction(film) else None
        text = embed_map(film, trigger=trigger, coding=kept.coding, predicted=predicted)
        element = Markup('<script type="text/plain" id="map-{}">{}</script>')
        scripts.append(element.format(trigger, text))
        progress("maps", done + 1, len(kept.triggers))
    return Markup("\n").join(scripts)


def _summary_section(film: xr.Dataset, shares: Array) -> Markup:
    """Write what a reader wants first, and the warnings."""
    notes = split_notes(str(film.attrs.get("notes", "")))
    return layout.render(
        "summary.html",
        rows=describe_briefly(film, shares),
        warnings=dict.fromkeys(text for level, text in notes if level is not Level.NOTE),
    )


def _numbers_section(source: FigureSource, shares: Array) -> Markup:
    """Write the tables of numbers, and the notes."""
    film = source.film
    notes = split_notes(str(film.attrs.get("notes", "")))
    return layout.render(
        "numbers.html",
        results=tables.results_table(film, shares),
        limits=tables.theory_limits(film),
        calibration=tables.calibration_table(source),
        registration=tables.registration_table(
            source.group("registration"), source.group("frames")
        ),
        flags=tables.flag_table(shares[:, 1:].mean(axis=0)),
        notes=dict.fromkeys(text for level, text in notes if level is Level.NOTE),
    )


def figures_section(
    source: FigureSource, progress: Progress = silent, *, room: float = float("inf")
) -> Markup:
    """Draw all figures of a film, results first, and list what is left out with the reason.

    Parameters
    ----------
    source : FigureSource
    progress : Progress
        Called before each figure.
    room : float
        Bytes that all figures may take; the largest are left out until the others fit.
    """
    parts, missing = [], []
    names = [name for name in DRAWN if name in figures_of(source.film)]
    for done, name in enumerate(sorted(names, key=[*_FIRST, *DRAWN].index)):
        progress("figures", done, len(DRAWN))
        caption = caption_of(name, source.film)
        reason = reason_missing(name, source)
        if reason is not None:
            missing.append((caption.title, reason))
            continue
        if name in _OF_ONE_TRIGGER:
            trigger = files.describe_trigger(source.film, source.trigger).capitalize()
            caption = replace(caption, text=f"{trigger}. {caption.text}")
        with in_style(None):
            parts.append(layout.embed_figure(name, DRAWN[name](source), caption))
    progress("figures", len(DRAWN), len(DRAWN))

    reason = Markup(
        "too large for this page; <code>erlif figures</code> draws it, <code>--max-size</code> "
        "allows a larger page"
    )
    while sum(len(one.source) for one in parts) > room:
        largest = max(parts, key=lambda one: len(one.source))
        parts.remove(largest)
        missing.append((largest.title, reason))
    return layout.arrange_figures(parts, missing)


def provenance_section(film: xr.Dataset) -> Markup:
    """Write history, settings and the hashes of all inputs."""
    calibration = json.loads(str(film.attrs.get("calibration", "{}")))
    inputs = {
        "Inputs of the run": json.loads(str(film.attrs.get("input_hashes", "{}"))),
        "Inputs of the calibration": calibration.get("input_hashes", {}),
        "Inputs of the calibration after the run": calibration.get("later", {}).get(
            "input_hashes", {}
        ),
    }
    rows = {
        title: layout.PageTable(list(hashes.items()), ("File", "SHA-256"))
        for title, hashes in inputs.items()
    }
    return layout.render(
        "provenance.html",
        history=film.attrs.get("history", ""),
        settings=film.attrs["settings"],
        inputs=rows.items(),
    )
