"""The page of ``erlif check``: findings, pairs and pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from markupsafe import Markup

from erlif.core.notes import Level
from erlif.core.units import count_of
from erlif.core.version import __version__
from erlif.review.check import Examination
from erlif.show.plots import check as pictures
from erlif.show.plots.style import AnyFigure
from erlif.show.report import layout
from erlif.show.report.captions import CAPTIONS

_TITLES = {Level.ERROR: "Errors", Level.WARNING: "Warnings", Level.NOTE: "Found"}


def write_check_page(found: Examination, out_path: str | Path, *, overwrite: bool = False) -> Path:
    """Write one self-contained HTML page about an audit.

    Parameters
    ----------
    found : Examination
        From `erlif.review.check.examine`.
    out_path, overwrite
        As for `erlif.show.report.write_report`, as what is returned and raised.

    Returns
    -------
    Path
        That of the page.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.review.check import examine
    >>> with TemporaryDirectory() as directory:
    ...     page = write_check_page(examine("nowhere"), f"{directory}/check.html")
    ...     text = page.read_text("utf-8")
    >>> text[:15], "there is no such directory" in text
    ('<!DOCTYPE html>', True)
    """
    return layout.write_page(lambda: _make_page(found), out_path, overwrite=overwrite)


def _make_page(found: Examination) -> str:
    sections = [("findings", "Findings", _findings(found))]
    if found.pairs:
        sections.append(("pairs", "Pairs", _pair_table(found)))
    figures = layout.arrange_figures(
        layout.embed_figure(name, figure, CAPTIONS[name]) for name, figure in _figures(found)
    )
    if figures:
        sections.append(("figures", "Figures", figures))
    return layout.compose_page(
        sections,
        name=found.name or found.directory.name or str(found.directory),
        subject="check",
        subtitle=f"Audit before computing, erlif {__version__}",
    )


def _findings(found: Examination) -> Markup:
    """Verdict, then errors, warnings and notes; the pairs have a table of their own."""
    counted = Counter(note.level for note in found.notes)
    errors, warnings = counted[Level.ERROR], counted[Level.WARNING]
    pairs = [note for note in found.notes if (note.level, note.subject) == (Level.NOTE, "pairs")]
    tables = []
    for level, title in _TITLES.items():
        notes = [note for note in found.notes if note.level is level and note not in pairs]
        rows = [(note.subject, layout.print_units(note.text)) for note in notes]
        tables.append(layout.PageTable(rows, (), title))
    return layout.render(
        "findings.html",
        verdict=f"{count_of(errors, 'error')}, {count_of(warnings, 'warning')}.",
        findings=[one for one in tables if one.rows],
    )


def _pair_table(found: Examination) -> Markup:
    """The first, the last and all odd pairs."""
    rows = []
    for one in found.pairs:
        logged = (one.row, "d"), (one.angle, ".2f"), (one.time, ".6g")
        cells = ("" if value is None else format(value, form) for value, form in logged)
        rows.append((str(one.pair), one.camera1, one.camera2, *cells))
    head = ("pair", "camera 1", "camera 2", "log frame", "angle [deg]", "time [s]")
    return layout.render(
        "pairs.html", pairs=layout.PageTable(rows, head, "First, last and odd pairs", (0, 3, 4, 5))
    )


def _figures(found: Examination) -> Iterator[tuple[str, AnyFigure]]:
    """Name and figure of each picture that the audit allows."""
    # an audit that ends early has no later pictures
    if found.cameras is not None:
        yield "pair", pictures.pair_figure(found.cameras.picture)
        yield "difference", pictures.difference_figure(found.cameras.picture)
    if found.survey is not None:
        yield "counts", pictures.histogram_figure(found.survey)
        yield "light", pictures.light_figure(found.survey, found.darks)
    figure = None if found.steps is None else pictures.steps_figure(found.steps)
    if figure is not None:
        yield "steps", figure
