"""``erlif calibrate``: a fixture directory to a calibration, compared with an earlier one."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from erlif.commands.lines import verbosity, wrap
from erlif.commands.options import (
    ALLOW_OUTSIDE,
    OVERWRITE,
    PATH,
    SKIP_BAD_FRAMES,
    expect_output,
    output_option,
)
from erlif.commands.progress import working
from erlif.core.errors import CalibrationError, ErlifError
from erlif.core.speed.imports import large_imports

if TYPE_CHECKING:
    from erlif.calibration import Calibration


@click.command()
@click.argument("fixture_dir", type=PATH)
@output_option("File", "FIXTURE_DIR/calibration.nc")
@click.option("--against", type=PATH, help="Report the drift from this earlier calibration.")
@SKIP_BAD_FRAMES
@ALLOW_OUTSIDE
@OVERWRITE
def calibrate(
    fixture_dir: Path,
    output: Path | None,
    against: Path | None,
    overwrite: bool,
    **reading: Any,
) -> None:
    """Fit the ratio-thickness calibration to a fixture.

    Writes calibration.nc and its figure. The new calibration is compared with the one that
    --against names, and with one of the same fixture that --overwrite replaces.

    \b
    Example:
      erlif calibrate calibration/wedge
      erlif calibrate calibration/wedge -o new.nc \\
          --against calibration/wedge/calibration.nc
    """
    with large_imports():
        from erlif import pipeline
        from erlif.calibration import save_calibration
        from erlif.show.plots import write_calibration_figure
        from erlif.show.report import describe_calibration

    # everything that can be refused is refused before the work starts
    output = output or fixture_dir / "calibration.nc"
    picture = output.with_suffix(".png")
    expect_output(output, ".nc", overwrite=overwrite, holds="ratio_at_zero")
    expect_output(picture, ".png", overwrite=overwrite)
    earlier = None if against is None else _open_comparable(against, fixture_dir)
    replaced = _open_replaced(output)

    with working() as progress:
        calibration = pipeline.calibrate(fixture_dir, progress=progress, **reading)
    save_calibration(calibration, output, overwrite=overwrite)
    figure = write_calibration_figure(calibration, picture)

    click.echo(wrap(describe_calibration(calibration, brief=not verbosity())))
    if earlier is not None:
        click.echo(wrap(f"against {against}: {_compare(calibration, earlier)}"))
    if replaced is not None and replaced.fixture == calibration.fixture and output != against:
        click.echo(wrap(f"against the one replaced: {_compare(calibration, replaced)}"))
    click.echo(f"written: {output}, {figure}")
    outside = " --allow-outside" * reading["allow_outside"]
    click.echo(f"next: name it as calibration in run.toml; erlif process RUN_DIR{outside}")


def _open_replaced(output: Path) -> Calibration | None:
    """The calibration that the new one replaces, if there is a readable one."""
    from erlif.calibration import open_calibration

    if output.exists():
        with suppress(ErlifError):  # the user has allowed to replace a damaged file too
            return open_calibration(output)
    return None


def _open_comparable(against: Path, fixture_dir: Path) -> Calibration:
    """The calibration to compare with; refused where its bands differ from the fixture's."""
    from erlif.calibration import open_calibration, share_bands
    from erlif.io.settings import read_fixture_settings

    earlier, settings = open_calibration(against), read_fixture_settings(fixture_dir)
    bands = settings.camera1.band, settings.camera2.band
    if not share_bands(earlier.bands, bands):
        raise CalibrationError(
            f"Expected --against to name a calibration of the bands in fixture.toml, {bands[0]:g} "
            f"and {bands[1]:g} nm; {against} is of {earlier.bands[0]:g} and {earlier.bands[1]:g} "
            "nm. Name one made with the same filters, or leave --against out."
        )
    return earlier


def _compare(calibration: Calibration, earlier: Calibration) -> str:
    """Verdict on the drift, or the reason why there is none."""
    from erlif.calibration import compare_calibrations

    try:
        return compare_calibrations(calibration, earlier).verdict
    except CalibrationError as error:
        return f"not compared. {error}"
