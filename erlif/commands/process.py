"""``erlif process``: a run directory to film-thickness maps."""

from __future__ import annotations

from os.path import normpath
from pathlib import Path
from typing import Any

import click

from erlif.commands.options import CALIBRATION, PATH, PROCESSING, expect_suffix
from erlif.commands.progress import working
from erlif.core.speed.imports import large_imports


@click.command()
@click.argument("run_dir", type=PATH)
@CALIBRATION
@click.option(
    "-o", "--output", type=PATH, help="Default: RUN_DIR/film.nc; a name in .zarr writes zarr."
)
@PROCESSING
def process(run_dir: Path, calibration: Path | None, output: Path | None, **options: Any) -> None:
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
    existed = source is None or source.exists()
    with working() as progress:
        film = pipeline.process(
            run_dir, calibration=calibration, output=output, progress=progress, **options
        )

    # the film stays open while it is summarised: its maps are read when they are used
    with film:
        click.echo(summarise(film))
    if source is not None and existed:
        click.echo(f"used: {source}")
    made = [source] if source is not None and not existed and source.exists() else []
    click.echo(f"written: {', '.join(str(path) for path in (*made, output))}")


def _named_calibration(run_dir: Path) -> Path | None:
    """The calibration that run.toml names; None where it cannot be read, which is refused later."""
    from erlif.core.errors import ErlifError
    from erlif.io.settings import read_run_settings

    try:
        named = read_run_settings(run_dir).calibrations
    except ErlifError:
        return None
    return Path(normpath(run_dir / named[0])) if len(named) == 1 else None
