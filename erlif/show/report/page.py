"""The report: one HTML page about a film that needs no other file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array
from erlif.core.errors import ErlifError
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.version import __version__
from erlif.io.files import (
    fastest_trigger,
    flag_shares,
    open_film,
    reading_film,
    refuse_existing,
    replacing,
    settings_of,
    takes,
)
from erlif.show.plots.files import FigureSource, find_source
from erlif.show.plots.prediction import has_prediction, predicted_map
from erlif.show.report.figures import figures_section
from erlif.show.report.layout import compose_page, read_resource
from erlif.show.report.maps import embed_map
from erlif.show.report.provenance import notes_list, provenance_section
from erlif.show.report.tables import (
    calibration_table,
    flag_table,
    registration_table,
    results_table,
    trigger_table,
)
from erlif.show.report.thinning import KeptMaps, choose_maps
from erlif.show.report.viewer import viewer_data, viewer_section

MAX_SIZE = 10.0
"""Largest size of a page, where none is given. [MB]"""

_PER_MB = 1e6  # bytes
_LEAST_SIZE = 0.5  # MB
_FIGURES = 0.6  # of the page, for figures at most
_TABLE = 0.2  # of the page, for the file of the triggers; as base64 it is a third longer
_FRAME = 60_000  # bytes of style, script, palettes and controls
_LESS = 0.97  # of the room that was exceeded, in another attempt


@takes(film_path="film file", out_path="path")
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
    ('<!DOCTYPE html>', 5)
    """
    report = choose_progress(progress)
    check_size(max_size)
    out_path = Path(out_path)
    refuse_existing(out_path, overwrite=overwrite)
    with reading_film(film_path), open_film(film_path) as film:
        chosen = _check_range(film, triggers)
        opening = chosen[fastest_trigger(film.isel(trigger=slice(chosen[0], chosen[-1] + 1)))]
        source = find_source(Path(film_path), film, opening, run_dir, fixture_dir)
        source = replace(source, allow_outside=allow_outside)
        text = _make_page(source, chosen, max_size, report)
    with replacing(out_path) as scratch:
        scratch.write_text(text, encoding="utf-8")
    return out_path


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
            f"Expected triggers from 0 to {count - 1}, the first before the last; got {first}-"
            f"{last}. Choose them with --triggers."
        )
    return range(first, last + 1)


def _make_page(source: FigureSource, triggers: range, max_size: float, progress: Progress) -> str:
    """Compose the sections, the embedded maps, the style and the script."""
    film, limit = source.film, _PER_MB * max_size
    shares = flag_shares(film)
    summary = _summary_section(source, shares)
    figures = figures_section(source, progress, room=_FIGURES * limit)
    table = trigger_table(film, shares[:, 0], most=_TABLE * limit)
    provenance = provenance_section(film)

    # what is left belongs to the maps; their size is measured, and fewer are kept if it is large
    others = sum(len(text.encode()) for text in (summary, figures, table, provenance))
    room = allowed = limit - others - _FRAME
    while True:
        kept = choose_maps(
            film,
            room=room,
            thickest=calibration_of(film).thickness_range[1],
            opening=source.trigger,
            triggers=triggers,
        )
        embedded = _embedded_maps(film, kept, progress)
        if len(embedded) <= allowed or len(kept.triggers) == 1:
            break
        room *= _LESS * allowed / len(embedded)

    viewer = viewer_section(
        film, kept.coding, triggers=kept.triggers, opening=source.trigger, limit=max_size
    )
    sections = [
        ("summary", "Summary", summary),
        ("viewer", "Film maps", viewer),
        ("figures", "Figures", figures),
        ("triggers", "Triggers", table),
        ("provenance", "Settings and inputs", provenance),
    ]
    # nothing of the time or the place of the report enters: the same film gives the same page
    version = str(film.attrs.get("erlif_version", __version__))
    scripts = f"""<script type="application/json" id="film-data">{
        viewer_data(film, kept.coding, triggers=kept.triggers)
    }</script>
{embedded}
<script>
{read_resource("viewer.js")}</script>
"""
    return compose_page(
        sections,
        name=settings_of(film).name,
        subject="oil-film thickness",
        subtitle=f"Oil-film thickness from two-camera fluorescence, erlif {version}",
        after=scripts,
    )


def _embedded_maps(film: xr.Dataset, kept: KeptMaps, progress: Progress) -> str:
    """Write every kept map as text in a script element of its own."""
    scripts = []
    for done, trigger in enumerate(kept.triggers):
        predicted = predicted_map(film, trigger=trigger) if has_prediction(film) else None
        text = embed_map(film, trigger=trigger, coding=kept.coding, predicted=predicted)
        scripts.append(f'<script type="text/plain" id="map-{trigger}">{text}</script>')
        progress("maps", done + 1, len(kept.triggers))
    return "\n".join(scripts)


def _summary_section(source: FigureSource, shares: Array) -> str:
    """Write the tables of the summary, and the notes."""
    film = source.film
    valid, flagged = float(shares[:, 0].mean()), shares[:, 1:].mean(axis=0)
    return "\n".join(
        [
            '<div class="columns"><div>',
            results_table(film, valid),
            "</div><div>",
            calibration_table(source),
            registration_table(source.group("registration"), source.group("frames")),
            "</div></div>",
            flag_table(flagged),
            notes_list(film),
        ]
    )
