"""The report: one HTML page about a film that needs no other file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import xarray as xr

from erlif.calibration import calibration_of
from erlif.core.arrays import Array
from erlif.core.progress import Progress, ShowProgress, choose_progress
from erlif.core.version import __version__
from erlif.files import (
    flag_shares,
    open_film,
    reading_film,
    refuse_existing,
    replacing,
    settings_of,
    takes,
)
from erlif.plots.files import FigureSource, find_source
from erlif.plots.prediction import has_prediction, predicted_map
from erlif.report.figures import figures_section
from erlif.report.layout import compose_page, read_resource
from erlif.report.maps import MapCoding, choose_coding, embed_map
from erlif.report.provenance import notes_list, provenance_section
from erlif.report.tables import (
    calibration_table,
    flag_table,
    registration_table,
    results_table,
    trigger_table,
)
from erlif.report.viewer import viewer_data, viewer_section


@takes(film_path="film file", out_path="path")
def write_report(
    film_path: str | Path,
    out_path: str | Path,
    *,
    run_dir: str | Path | None = None,
    fixture_dir: str | Path | None = None,
    overwrite: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> Path:
    """Write one self-contained HTML page about a film.

    The page holds a summary, a viewer of all maps, the figures, a table of the triggers, settings
    and input hashes. It loads nothing from the network and works when opened from a file. Where all
    pixels would make it larger than about 15 MB, it holds every second or third along each axis,
    and names this beside the viewer.

    Parameters
    ----------
    film_path : path
        ``film.nc`` or ``film.zarr``.
    out_path : path
        The page.
    run_dir, fixture_dir : path, optional
        As for `erlif.plots.write_figures`.
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

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.plots import write_example
    >>> with TemporaryDirectory() as directory:
    ...     film_path = write_example(f"{directory}/film.nc")
    ...     page = write_report(film_path, f"{directory}/report.html").read_text("utf-8")
    >>> page[:15], page.count("<h2")
    ('<!DOCTYPE html>', 5)
    """
    report = choose_progress(progress)
    out_path = Path(out_path)
    refuse_existing(out_path, overwrite=overwrite)
    with reading_film(film_path), open_film(film_path) as film:
        source = find_source(Path(film_path), film, None, run_dir, fixture_dir)
        text = _make_page(replace(source, allow_outside=allow_outside), report)
    with replacing(out_path) as scratch:
        scratch.write_text(text, encoding="utf-8")
    return out_path


def _make_page(source: FigureSource, progress: Progress) -> str:
    """Compose the sections, the embedded maps, the style and the script."""
    film = source.film
    coding = choose_coding(film, thickest=calibration_of(film).thickness_range[1])
    shares = flag_shares(film)
    sections = [
        ("summary", "Summary", _summary_section(source, shares)),
        ("viewer", "Film maps", viewer_section(film, coding, opening=source.trigger)),
        ("figures", "Figures", figures_section(source, progress)),
        ("triggers", "Triggers", trigger_table(film, shares[:, 0])),
        ("provenance", "Settings and inputs", provenance_section(film)),
    ]
    # nothing of the time or the place of the report enters: the same film gives the same page
    version = str(film.attrs.get("erlif_version", __version__))
    data = viewer_data(film, coding)
    scripts = f"""<script type="application/json" id="film-data">{data}</script>
{_embedded_maps(film, coding, progress)}
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


def _embedded_maps(film: xr.Dataset, coding: MapCoding, progress: Progress) -> str:
    """Write every map as text in a script element of its own."""
    scripts = []
    for trigger in range(film.sizes["trigger"]):
        predicted = predicted_map(film, trigger=trigger) if has_prediction(film) else None
        text = embed_map(film, trigger=trigger, coding=coding, predicted=predicted)
        scripts.append(f'<script type="text/plain" id="map-{trigger}">{text}</script>')
        progress("maps", trigger + 1, film.sizes["trigger"])
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
