"""Settings, input hashes and notes: what a result depends on."""

from __future__ import annotations

import json
from html import escape

import xarray as xr

from erlif.core.notes import Level
from erlif.show.report.tables import make_table, print_text


def provenance_section(film: xr.Dataset) -> str:
    """Write history, settings and the hashes of all inputs as HTML."""
    parts = [f"<p>{escape(str(film.attrs.get('history', '')))}</p>"]
    settings = escape(str(film.attrs["settings"]))
    parts.append(f"<details><summary>Settings</summary><pre>{settings}</pre></details>")

    calibration = json.loads(str(film.attrs.get("calibration", "{}")))
    for title, hashes in (
        ("Inputs of the run", json.loads(str(film.attrs.get("input_hashes", "{}")))),
        ("Inputs of the calibration", calibration.get("input_hashes", {})),
    ):
        rows = [
            (escape(name), f'<code class="hash">{escape(digest)}</code>')
            for name, digest in hashes.items()
        ]
        if rows:
            table = f'<div class="wide">{make_table(rows, head=("File", "SHA-256"))}</div>'
            parts.append(f"<details><summary>{title}</summary>{table}</details>")
    return "\n".join(parts)


def notes_list(film: xr.Dataset) -> str:
    """Write the notes of a film as an HTML list, each once; empty without notes."""
    notes = [line for line in str(film.attrs.get("notes", "")).split("\n") if line]
    if not notes:
        return ""
    items = "".join(f"<li>{_emphasise(note)}</li>" for note in dict.fromkeys(notes))
    return f"<h3>Notes</h3><ul>{items}</ul>"


def _emphasise(note: str) -> str:
    """A note as HTML, with the level of a warning in bold."""
    level, colon, rest = note.partition(": ")
    if level not in (Level.WARNING, Level.ERROR):
        return print_text(note)
    return f"<strong>{level.capitalize()}{colon}</strong>{print_text(rest)}"
