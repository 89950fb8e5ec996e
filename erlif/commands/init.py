"""``erlif init``: a first run.toml or fixture.toml from the files in a directory."""

from __future__ import annotations

import sys
import tomllib
from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

import click

from erlif.commands.lines import verbosity, wrap, wrap_note
from erlif.commands.options import PATH
from erlif.core.errors import ConfigError
from erlif.core.speed.imports import large_imports

# Those of `erlif.review.init`, which takes long to load.
KINDS = ("crank-rocker", "slider-crank", "rotation", "sinusoidal", "static")

DEFAULT_KIND = "crank-rocker"


def on_terminal() -> bool:
    """Whether standard input is a terminal, so that the user can be asked."""
    return sys.stdin.isatty()


@click.command()
@click.argument("directory", type=PATH)
@click.option("--fixture", is_flag=True, help="Write fixture.toml for a calibration fixture.")
@click.option(
    "--kind",
    type=click.Choice(KINDS),
    help="Tribometer of the run. Default: asked for on a terminal, else crank-rocker.",
)
@click.option(
    "--like",
    type=PATH,
    metavar="DIRECTORY",
    help="Earlier run, or fixture, of the rig: take what the rig keeps.",
)
@click.option("--full", is_flag=True, help="Write every optional key with its meaning.")
@click.option("--overwrite", is_flag=True, help="Replace an existing settings file.")
def init(
    directory: Path,
    fixture: bool,
    kind: str | None,
    like: Path | None,
    full: bool,
    overwrite: bool,
) -> None:
    """Write run.toml for the frames and logs in a directory.

    Fills in what the files determine: patterns, bit depth, darks and flats, triggers per cycle.
    Every other required value becomes a marked gap, "??", with its unit and meaning. The kind of
    the tribometer decides which are required: a linkage, a disc (rotation), a slider (sinusoidal)
    or a static film. A JSON schema for editors is written beside it. With --like, tribometer,
    optics, joint, columns and options are those of an earlier run; its oil and speed stand beside
    the gaps. The example takes the files of `erlif simulate rehearsal`.

    \b
    Example:
      erlif init rehearsal/run --overwrite
      erlif init rehearsal/fixture --fixture --overwrite
      erlif check rehearsal/run
    """
    with large_imports():
        from erlif.io.settings import read_fixture_settings, read_run_settings
        from erlif.review.init import init as write_settings

    if fixture and kind is not None:
        raise ConfigError(
            "Expected no --kind: it is that of a run, not of a fixture. Leave it out."
        )
    if kind is None:
        kind = DEFAULT_KIND
        if not fixture and like is None and on_terminal():
            kind = click.prompt("Tribometer", type=click.Choice(KINDS), default=DEFAULT_KIND)

    notes = write_settings(
        directory, fixture=fixture, kind=kind, overwrite=overwrite, full=full, like=like
    )
    for note in notes:
        click.echo(wrap_note(note))

    output = directory / ("fixture.toml" if fixture else "run.toml")
    click.echo(f"written: {output}")
    try:
        (read_fixture_settings if fixture else read_run_settings)(directory)
    except ConfigError as gaps:
        click.echo(wrap(str(gaps)) if verbosity() else "\n".join(_list_gaps(output)))
    click.echo(f"next: erlif check {directory}")


def _list_gaps(path: Path) -> Iterator[str]:
    """The keys that have no value yet, a line for each table."""
    from erlif.io.settings.reading import count_gaps, find_gaps

    found = list(find_gaps(tomllib.loads(path.read_text(encoding="utf-8"))))
    yield f"{count_gaps(found)}, with their meaning in the file. Replace each ??:"
    for table, gaps in groupby(found, key=lambda gap: ".".join(gap[:-1])):
        keys = ", ".join(gap[-1] for gap in gaps)
        yield f"  [{table}] {keys}" if table else f"  {keys}"
