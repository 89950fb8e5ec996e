"""``erlif process``: a run directory to film-thickness maps."""

from __future__ import annotations

from os.path import normpath
from pathlib import Path

import click

from erlif.commands.compiling import announced_compiling
from erlif.commands.options import (
    ALLOW_OUTSIDE,
    OVERWRITE,
    PATH,
    SCHEDULER,
    SKIP_BAD_FRAMES,
    WORKERS,
    expect_suffix,
)
from erlif.commands.progress import show_progress
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("run_dir", type=PATH)
@click.option("--calibration", type=PATH, help="Default: the calibration that run.toml names.")
@click.option(
    "-o", "--output", type=PATH, help="Default: RUN_DIR/film.nc; a name in .zarr writes zarr."
)
@WORKERS
@SCHEDULER
@SKIP_BAD_FRAMES
@ALLOW_OUTSIDE
@OVERWRITE
def process(
    run_dir: Path,
    calibration: Path | None,
    output: Path | None,
    workers: int | None,
    scheduler: str | None,
    skip_bad_frames: bool,
    allow_outside: bool,
    overwrite: bool,
) -> None:
    """Turn a run directory into film-thickness maps.

    Where run.toml names a calibration that does not exist yet, it is fitted from the fixture
    directory it belongs to. The same command resumes an interrupted run.

    \b
    Example:
      erlif process data_samples/straight_bushing
      erlif process long_run -o long_run/film.zarr --scheduler local:4
    """
    with large_imports():
        from erlif import pipeline
        from erlif.show.report import summarise

    # a name that promises another format is refused before the work starts
    output = output or run_dir / "film.nc"
    expect_suffix(output, ".nc", ".zarr")

    source = calibration or _named_calibration(run_dir)
    found = source is None or source.exists()
    with announced_compiling(), show_progress() as progress:
        film = pipeline.process(
            run_dir,
            calibration=calibration,
            output=output,
            overwrite=overwrite,
            skip_bad_frames=skip_bad_frames,
            allow_outside=allow_outside,
            workers=workers,
            scheduler=scheduler,
            progress=progress,
        )

    # the film stays open while it is summarised: its maps are read when they are used
    with film:
        click.echo(summarise(film))
    if source is not None and found:
        click.echo(f"used: {source}")
    made = [source] if source is not None and not found and source.exists() else []
    click.echo(f"written: {', '.join(str(path) for path in (*made, output))}")


def _named_calibration(run_dir: Path) -> Path | None:
    """The calibration that run.toml names; None where it cannot be read, which is refused later."""
    from erlif.core.errors import ErlifError
    from erlif.io.settings import read_run_settings

    try:
        named = read_run_settings(run_dir).calibration
    except ErlifError:
        return None
    return None if named is None else Path(normpath(run_dir / named))
