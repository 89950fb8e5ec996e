"""The commands. Each parses, calls, and says where the result went; whatever it does, a notebook can do."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from erlif.core.errors import CalibrationError, ErlifError, OutputError
from erlif.core.version import __version__
from erlif.rig.command import simulate

if TYPE_CHECKING:
    from collections.abc import Iterator

    from erlif.calibration import Calibration
import io
import logging
import sys
import traceback

import click

_DIRECTORY = click.Path(path_type=Path)


_OVERWRITE = click.option("--overwrite", is_flag=True, help="Replace an existing output.")


_SKIP = click.option(
    "--skip-bad-frames",
    is_flag=True,
    help="Leave out unreadable frame pairs and say so in the output.",
)


class _Commands(click.Group):
    """Answer bad input with one message and status 2, a defect of ours with a traceback and status 1."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except ErlifError as error:
            click.echo(f"erlif: {error}", err=True)
            ctx.exit(2)
        except (click.ClickException, click.exceptions.Exit, click.Abort):
            raise
        except KeyboardInterrupt:
            click.echo(
                "erlif: interrupted; what was written before is as it was, and the next start resumes.",
                err=True,
            )
            ctx.exit(130)
        except BrokenPipeError:
            ctx.exit(1)
        except OSError as error:
            click.echo(
                f"erlif: {error.strerror or error}: {error.filename or ''}. What was written before is as it was.",
                err=True,
            )
            ctx.exit(2)
        except Exception:
            traceback.print_exc()
            click.echo(
                "erlif: this is a defect of erlif; please report it with the lines above.", err=True
            )
            ctx.exit(1)


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, prog_name="erlif")
@click.option("-v", "--verbose", is_flag=True, help="Say more about what is done.")
def main(verbose: bool) -> None:
    """Oil-film thickness maps with honest error bars from two-camera fluorescence.

    \b
    Example:
      erlif simulate rehearsal
      erlif calibrate rehearsal/fixture
      erlif process rehearsal/run
      erlif figures rehearsal/run/film.nc
    """
    logging.basicConfig(
        level=logging.INFO if verbose else logging.WARNING, format="%(name)s: %(message)s"
    )
    logging.getLogger("tifffile").setLevel(
        logging.CRITICAL
    )  # what it finds in damaged files, erlif says itself
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without the signs of the trade


main.add_command(simulate)


@contextmanager
def _progress() -> Iterator[Callable[[str, int, int], None]]:
    """A bar on a terminal, a plain line per piece of work elsewhere."""
    from tqdm import tqdm

    plain = not sys.stderr.isatty()
    bars: dict[str, Any] = {}

    def show(what: str, done: int, total: int) -> None:
        if plain:
            if done == total and what not in bars:
                bars[what] = None
                click.echo(f"{what}: {total} done", err=True)
            return
        if what not in bars:
            for bar in bars.values():
                bar.close()
            bars[what] = tqdm(total=total, desc=what, unit="pair", leave=False)
        bar = bars[what]
        bar.n = min(done, total)
        bar.refresh()

    try:
        yield show
    finally:
        for bar in bars.values():
            if bar is not None:
                bar.close()


def _expect_suffix(output: Path, *suffixes: str) -> None:
    """Refuse a name that promises another kind of file than is written."""
    if output.suffix not in suffixes:
        raise OutputError(
            f"Expected a name in {' or '.join(suffixes)} for the output; got {output.name}."
        )


@main.command()
@click.argument("directory", type=_DIRECTORY)
def check(directory: Path) -> None:
    """Audit a run or fixture directory before anything is computed.

    \b
    Example:
      erlif check data_samples/straight_bushing
    """
    from erlif.pipeline import check as check_directory

    findings = check_directory(directory)
    for finding in findings:
        click.echo(str(finding))
    if any(finding.level == "error" for finding in findings):
        raise click.exceptions.Exit(2)


@main.command()
@click.argument("fixture_dir", type=_DIRECTORY)
@click.option("-o", "--output", type=_DIRECTORY, help="Default: FIXTURE_DIR/calibration.nc.")
@click.option(
    "--against", type=_DIRECTORY, help="Say whether the calibration drifted from this one."
)
@_SKIP
@_OVERWRITE
def calibrate(
    fixture_dir: Path,
    output: Path | None,
    against: Path | None,
    skip_bad_frames: bool,
    overwrite: bool,
) -> None:
    """Fit the ratio-thickness calibration to a fixture; writes calibration.nc and its figure.

    A calibration of the same fixture that --overwrite replaces is compared with the new one, as is the one named by --against.
    Where they share no film there is nothing to compare: one line says so, and the new calibration is written all the same.

    \b
    Example:
      erlif calibrate calibration/wedge
      erlif calibrate calibration/wedge_in_may --against calibration/wedge/calibration.nc
    """
    from erlif import pipeline
    from erlif.calibration import open_calibration, save_calibration
    from erlif.files import refuse_existing
    from erlif.report import describe_calibration

    output = output or fixture_dir / "calibration.nc"
    _expect_suffix(output, ".nc")
    refuse_existing(output, overwrite=overwrite)
    picture = output.with_suffix(".png")
    if picture.exists() and not overwrite:
        raise OutputError(
            f"{picture} exists already; use --overwrite to replace it, or -o for another name."
        )
    earlier = None if against is None else _open_comparable(against, fixture_dir)
    replaced = None
    if output.exists():
        with suppress(ErlifError):  # whatever it is, it was said that it may be replaced
            replaced = open_calibration(output)
    with _progress() as progress:
        calibration = pipeline.calibrate(
            fixture_dir, skip_bad_frames=skip_bad_frames, progress=progress
        )
    save_calibration(calibration, output, overwrite=overwrite)
    from erlif.plots import write_calibration_figure

    figure = write_calibration_figure(calibration, picture)
    click.echo(describe_calibration(calibration))
    if earlier is not None:
        click.echo(f"against {against}: {_compare(calibration, earlier)}")
    if replaced is not None and replaced.fixture == calibration.fixture and output != against:
        click.echo(f"against the one replaced: {_compare(calibration, replaced)}")
    click.echo(f"written: {output}, {figure}")


def _open_comparable(against: Path, fixture_dir: Path) -> Calibration:
    """The calibration to compare with, refused before the work if it is of other bands than the fixture."""
    from erlif.calibration import open_calibration, share_bands
    from erlif.settings import read_fixture_settings

    earlier, settings = open_calibration(against), read_fixture_settings(fixture_dir)
    bands = settings.camera1.band, settings.camera2.band
    if not share_bands(earlier.bands, bands):
        raise CalibrationError(
            f"Expected --against to name a calibration of the bands in fixture.toml, {bands[0]:g} and {bands[1]:g} nm; {against} is of "
            f"{earlier.bands[0]:g} and {earlier.bands[1]:g} nm. Name one made with the same filters, or leave --against out."
        )
    return earlier


def _compare(calibration: Calibration, earlier: Calibration) -> str:
    """The verdict on drift, or why there is none: the calibration is written and stays."""
    from erlif.calibration import compare_calibrations

    try:
        return compare_calibrations(calibration, earlier).verdict
    except CalibrationError as error:
        return f"not compared. {error}"


@main.command()
@click.argument("run_dir", type=_DIRECTORY)
@click.option("--calibration", type=_DIRECTORY, help="Default: the one run.toml names.")
@click.option(
    "-o", "--output", type=_DIRECTORY, help="Default: RUN_DIR/film.nc; a name in .zarr writes zarr."
)
@click.option("--workers", type=click.IntRange(min=1), help="Threads; default: one per processor.")
@_SKIP
@_OVERWRITE
def process(
    run_dir: Path,
    calibration: Path | None,
    output: Path | None,
    workers: int | None,
    skip_bad_frames: bool,
    overwrite: bool,
) -> None:
    """Turn a run directory into film-thickness maps.

    A calibration that run.toml names and that was not made yet is fitted from the fixture beside it. An interrupted
    run is resumed by the same command.

    \b
    Example:
      erlif process data_samples/straight_bushing
    """
    from erlif import pipeline
    from erlif.report import summarise

    output = output or run_dir / "film.nc"
    _expect_suffix(output, ".nc", ".zarr")
    with _progress() as progress:
        film = pipeline.process(
            run_dir,
            calibration=calibration,
            output=output,
            overwrite=overwrite,
            skip_bad_frames=skip_bad_frames,
            workers=workers,
            progress=progress,
        )
    with film:
        click.echo(summarise(film))
    click.echo(f"written: {output}")


@main.command()
@click.argument("run_dir", type=_DIRECTORY)
@click.option("--calibration", type=_DIRECTORY, help="Default: the one run.toml names.")
@click.option("--trigger", type=click.IntRange(min=0), help="Default: the fastest.")
@click.option(
    "--film",
    "films",
    type=float,
    multiple=True,
    help="Film in um to make the budget for; may be repeated.",
)
def budget(
    run_dir: Path, calibration: Path | None, trigger: int | None, films: tuple[float, ...]
) -> None:
    """Print the uncertainty of one map, term by term.

    \b
    Example:
      erlif budget data_samples/straight_bushing --trigger 12
    """
    from erlif.pipeline import budget as make_budget
    from erlif.pipeline import render_budget

    with _progress() as progress:
        found = make_budget(
            run_dir,
            trigger=trigger,
            calibration=calibration,
            films=films or None,
            progress=progress,
        )
    click.echo(render_budget(found), nl=False)


@main.command()
@click.argument("film", type=_DIRECTORY)
@click.option("-o", "--output", type=_DIRECTORY, help="Default: figures/ beside FILM.")
@_OVERWRITE
def figures(film: Path, output: Path | None, overwrite: bool) -> None:
    """Write the figures of a film as PNG and PDF.

    \b
    Example:
      erlif figures data_samples/straight_bushing/film.nc
    """
    from erlif.plots import write_figures

    output = output or film.parent / "figures"
    if output.is_file():
        raise OutputError(
            f"Expected a directory for the figures; {output} is a file. Give another name with -o."
        )
    for path in write_figures(film, output, overwrite=overwrite):
        click.echo(str(path))


@main.command()
@click.argument("film", type=_DIRECTORY)
@click.option("-o", "--output", type=_DIRECTORY, help="Default: report.html beside FILM.")
@_OVERWRITE
def report(film: Path, output: Path | None, overwrite: bool) -> None:
    """Write one self-contained HTML page about a film.

    \b
    Example:
      erlif report data_samples/straight_bushing/film.nc
    """
    from erlif.report import write_report

    output = output or film.parent / "report.html"
    _expect_suffix(output, ".html")
    click.echo(str(write_report(film, output, overwrite=overwrite)))


@main.command()
def sources() -> None:
    """Print the published numbers of the sources against what the models give.

    \b
    Example:
      erlif sources > docs/sources.md
    """
    from erlif.models.sources import render_sources

    click.echo(render_sources(), nl=False)
