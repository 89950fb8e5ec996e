"""``erlif check``: an audit of a run or fixture directory."""

from __future__ import annotations

import json
from pathlib import Path

import click

from erlif.commands.ending import BAD_INPUT, DEFECT
from erlif.commands.lines import list_notes
from erlif.commands.options import (
    ALLOW_OUTSIDE,
    OVERWRITE,
    PATH,
    SKIP_BAD_FRAMES,
    expect_output,
    output_option,
)
from erlif.commands.progress import working
from erlif.core.notes import Level
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("directory", type=PATH)
@click.option("--strict", is_flag=True, help="End with status 1 where there are warnings.")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON.")
@output_option("Page with pictures (.html)", "none")
@SKIP_BAD_FRAMES
@ALLOW_OUTSIDE
@OVERWRITE
def check(
    directory: Path,
    strict: bool,
    as_json: bool,
    output: Path | None,
    overwrite: bool,
    **options: bool,
) -> None:
    """Audit a run or fixture directory before anything is computed.

    Lists what was found and ends with exit status 2 at the first error. Gaps in run.toml or
    fixture.toml are listed all at once, one line each.

    \b
    Example:
      erlif check data_samples/straight_bushing
      erlif check data_samples/straight_bushing -o check.html
    """
    with large_imports():
        from erlif.review.check import examine

    if output is not None:
        expect_output(output, ".html", overwrite=overwrite)
    with working(lines=False) as progress:
        findings = examine(directory, progress=progress, **options)
    # one form of the findings alone goes to standard output, so that programs can read it
    if as_json:
        click.echo(json.dumps(findings.to_record(), indent=1))
    else:
        for line in list_notes(findings.notes, "-v, or a page with -o check.html"):
            click.echo(line)
    if output is not None:
        from erlif.show.report import write_check_page

        written = write_check_page(findings, output, overwrite=overwrite)
        click.echo(f"written: {written}", err=True)  # the findings stay a table of their own

    if findings.count(Level.ERROR):
        raise click.exceptions.Exit(BAD_INPUT)
    if strict and findings.count(Level.WARNING):
        raise click.exceptions.Exit(DEFECT)
    if not as_json:
        command = "calibrate" if (directory / "fixture.toml").is_file() else "process"
        stated = "".join(f" --{name.replace('_', '-')}" for name, on in options.items() if on)
        click.echo(f"next: erlif {command} {directory}{stated}", err=True)
