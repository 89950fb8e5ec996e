"""``erlif report``: one HTML page about a film."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from erlif.commands.options import (
    ALLOW_OUTSIDE,
    OVERWRITE,
    PATH,
    QuantityOption,
    expect_suffix,
    output_option,
)
from erlif.commands.progress import working
from erlif.core.errors import ErlifError
from erlif.core.speed.imports import large_imports


def first_and_last(
    ctx: click.Context, option: click.Parameter, value: str | None
) -> tuple[int, int] | None:
    """Split a range of triggers at its hyphen; one trigger is first and last."""
    if value is None:
        return None
    first, hyphen, last = value.partition("-")
    if not hyphen:
        last = first
    if not (first.strip().isdecimal() and last.strip().isdecimal()):
        raise ErlifError(
            f"Expected a trigger or a range of triggers, such as 12 or 100-149; got {value}. Give "
            "it with --trigger."
        )
    return int(first), int(last)


@click.command()
@click.argument("films", type=PATH, nargs=-1, required=True, metavar="FILM...")
@output_option("Page", "report.html beside FILM, of several films here")
@click.option(
    "--trigger",
    "triggers",
    callback=first_and_last,
    metavar="N|FROM-TO",
    help="Triggers whose maps the page holds, counted from 0; default: all that fit.",
)
@click.option(
    "--max-size",
    type=QuantityOption("MB", "SIZE"),
    default="10 MB",
    show_default=True,
    help="Largest size of the page; it states what was left out.",
)
@ALLOW_OUTSIDE
@OVERWRITE
def report(
    films: tuple[Path, ...],
    output: Path | None,
    triggers: tuple[int, int] | None,
    allow_outside: bool,
    **options: Any,
) -> None:
    """Write one HTML page about a film, or about several films.

    \b
    Example:
      erlif report data_samples/straight_bushing/film.nc
      erlif report film.nc --trigger 100-149 -o some.html
      erlif report run_*/film.nc -o runs.html
    """
    with large_imports():
        from erlif.show.report import write_report, write_runs_report

    several = len(films) > 1
    output = output or (Path("report.html") if several else films[0].parent / "report.html")
    expect_suffix(output, ".html")
    if several and triggers is not None:
        raise ErlifError(
            f"Expected one film with --trigger; got {len(films)}. Leave out --trigger, or name one "
            "film."
        )
    # several films share a page; triggers and images belong to a single one
    with working() as progress:
        if several:
            write_runs_report(films, output, progress=progress, **options)
        else:
            options |= {"triggers": triggers, "allow_outside": allow_outside}
            write_report(films[0], output, progress=progress, **options)
    click.echo(f"written: {output}")
