"""``erlif sample``: the sample run of README, for those who have no checkout."""

from __future__ import annotations

from pathlib import Path

import click

from erlif.commands.progress import show_progress
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("out", type=click.Path(path_type=Path, file_okay=False))
@click.option("--overwrite", is_flag=True, help="Replace the sample in OUT.")
def sample(out: Path, overwrite: bool) -> None:
    """Write a sample run to try erlif with.

    A virtual rig photographs a known film. Writes OUT/run, its fixture before and after the run,
    and OUT/truth.nc with the true film thickness; 23 MB.

    \b
    Example:
      erlif sample first
      erlif process first/run
      erlif figures first/run/film.nc
    """
    with large_imports():
        from erlif.rig.sample import write_sample

    with show_progress() as progress:
        write_sample(out, overwrite=overwrite, progress=progress)
    click.echo(f"written: {out}; next: erlif process {out / 'run'}")
