"""``erlif check``: an audit of a run or fixture directory."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.options import ALLOW_OUTSIDE, PATH
from erlif.core.notes import Level


@click.command()
@click.argument("directory", type=PATH)
@ALLOW_OUTSIDE
def check(directory: Path, allow_outside: bool) -> None:
    """Audit a run or fixture directory before anything is computed.

    Lists what was found and ends with exit status 2 at the first error. Gaps in run.toml or
    fixture.toml are listed all at once, one line each.

    \b
    Example:
      erlif check data_samples/straight_bushing
    """
    from erlif.pipeline.check import check as check_directory

    notes = check_directory(directory, allow_outside=allow_outside)
    for note in notes:
        click.echo(f"{note.level:8s}{note}")
    if any(note.level is Level.ERROR for note in notes):
        raise click.exceptions.Exit(2)
