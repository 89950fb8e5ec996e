"""``erlif check``: an audit of a run or fixture directory."""

from __future__ import annotations

import json
from pathlib import Path

import click

from erlif.commands.options import ALLOW_OUTSIDE, PATH
from erlif.commands.status import BAD_INPUT, DEFECT
from erlif.core.notes import Level


@click.command()
@click.argument("directory", type=PATH)
@click.option("--strict", is_flag=True, help="End with status 1 where there are warnings.")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@ALLOW_OUTSIDE
def check(directory: Path, strict: bool, as_json: bool, allow_outside: bool) -> None:
    """Audit a run or fixture directory before anything is computed.

    Lists what was found and ends with exit status 2 at the first error. Gaps in run.toml or
    fixture.toml are listed all at once, one line each.

    \b
    Example:
      erlif check data_samples/straight_bushing
    """
    from erlif.audit import audit

    found = audit(directory, allow_outside=allow_outside)
    if as_json:
        click.echo(json.dumps(found.to_record(), indent=1))
    else:
        for note in found.notes:
            click.echo(f"{note.level:8s}{note}")

    if found.count(Level.ERROR):
        raise click.exceptions.Exit(BAD_INPUT)
    if strict and found.count(Level.WARNING):
        raise click.exceptions.Exit(DEFECT)
