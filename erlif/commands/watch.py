"""``erlif watch``: the film while a run is recorded."""

from __future__ import annotations

import re
import subprocess
import time
import webbrowser
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

import click

from erlif.commands.ending import EndedBySignal, echo_aside
from erlif.commands.options import (
    CALIBRATION,
    PATH,
    PROCESSING,
    QuantityOption,
    expect_output,
    output_option,
)
from erlif.commands.process import process_one
from erlif.commands.progress import announced_compiling
from erlif.commands.view import leading_to
from erlif.core.errors import EncoderError, ErlifError, FrameError
from erlif.core.speed.imports import large_imports
from erlif.core.units import count_of

if TYPE_CHECKING:
    from erlif.pipeline.watch.follow import Follower
    from erlif.pipeline.watch.setup import SetupWatch
    from erlif.pipeline.watch.watch import Watch, WatchState

# Exit status of a run in which an alarm was raised.
ALARMED = 3

# Time between two lines on the terminal. [s]
_EVERY = 1.0

# Time between two looks at the state. [s]
_LOOK = 0.2


@click.command()
@click.argument("run_dir", type=PATH)
@CALIBRATION
@output_option("File in .nc or .zarr", "RUN_DIR/film.nc")
@click.option(
    "--quiet",
    type=QuantityOption("s", "TIME"),
    help='End after this time without a new pair, such as "10 s". Default: at Ctrl-C, or when a '
    "file named stop appears in RUN_DIR.",
)
@click.option(
    "--film-below",
    type=QuantityOption("um", "LENGTH"),
    help='Alarm where the minimum film is thinner, such as "2 um".',
)
@click.option(
    "--saturated-above",
    type=QuantityOption("percent", "SHARE"),
    help='Alarm where more pixels of a camera saturate, such as "1 %".',
)
@click.option(
    "--no-pulse-for",
    type=QuantityOption("s", "TIME"),
    help='Alarm where no pair comes for longer, such as "2 s".',
)
@click.option(
    "--on-alarm", metavar="COMMAND", help="Command that is run when an alarm is first raised."
)
@click.option(
    "--setup",
    "trial",
    is_flag=True,
    help="Before the run: show both cameras and what to turn. Nothing is written.",
)
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Default: a free one.")
@click.option("--no-browser", is_flag=True, help="Print the address and open no browser.")
@PROCESSING
def watch(
    run_dir: Path,
    calibration: Path | None,
    output: Path | None,
    quiet: float | None,
    film_below: float | None,
    saturated_above: float | None,
    no_pulse_for: float | None,
    on_alarm: str | None,
    trial: bool,
    port: int,
    no_browser: bool,
    **options: Any,
) -> None:
    """Show the film while a run is recorded, then process the run.

    Begins before the first frame exists. The page in the browser shows the newest map, the film
    with its error, light and saturation of both cameras, and frames that are missing. What it shows
    is found from the pairs so far; the film that is written at the end is that of erlif process.
    The exit status is 3 where an alarm was raised.

    \b
    Example:
      erlif watch run_12 --film-below "2 um" --no-pulse-for "2 s" --quiet "10 s"
    """
    with large_imports():
        from erlif.pipeline.watch.alarms import Alarms
        from erlif.pipeline.watch.setup import SetupWatch
        from erlif.pipeline.watch.watch import Watch

    _await_settings(run_dir)
    show = partial(_show_page, port=port, browser=not no_browser)
    if trial:
        trials = SetupWatch(run_dir, allow_outside=options["allow_outside"])
        with show(trials, page="setup.html"), _ending(trials):
            with trials.running():
                _follow_setup(trials)
            trials.announce("The setup has ended.", closed=True)
        return

    share = None if saturated_above is None else saturated_above / 100
    output = output or run_dir / "film.nc"
    expect_output(output, ".nc", ".zarr", overwrite=options["overwrite"], holds="thickness")
    watched = Watch(
        run_dir,
        calibration=calibration,
        alarms=Alarms(film_below, share, no_pulse_for),
        workers=options["workers"],
        allow_outside=options["allow_outside"],
    )
    with show(watched, page="live.html"), _ending(watched):
        with announced_compiling(), watched.running():
            _follow(watched, quiet, on_alarm)
        if not watched.state().arrived:
            raise FrameError(
                f"Expected frame pairs in {run_dir} before the end of the watch; none has come. "
                "Check the names of the frames under [camera1] and [camera2] in run.toml, and "
                "start again."
            )
        watched.announce("The recording has ended; the run is being processed.")
        summary = _finish(run_dir, calibration, output, options)
        text = f"{output.name} is written.\n{summary}\nLook at it: erlif view {output}"
        watched.announce(text, closed=True)
    if watched.alarmed:
        for text in watched.alarmed.values():
            echo_aside(f"alarm: {text}")
        click.get_current_context().exit(ALARMED)


def _await_settings(run_dir: Path) -> None:
    """Wait for a directory that does not exist yet, and for the settings in it."""
    if run_dir.exists():
        return
    settings = run_dir / "run.toml"
    echo_aside(f"{run_dir} does not exist yet: waiting for {settings}. Ctrl-C ends the watch.")
    while not settings.exists():
        time.sleep(_LOOK)
    time.sleep(_EVERY)  # what the settings name may still be on its way


def _finish(run_dir: Path, calibration: Path | None, output: Path, options: dict[str, Any]) -> str:
    """Process the run; without its bad frames where it is refused because of them."""
    from erlif.pipeline.recording.pulses import PulseError

    try:
        return process_one(run_dir, calibration, output, options)
    except (FrameError, EncoderError) as error:
        if options["skip_bad_frames"] or isinstance(error, PulseError):
            raise
        reason = str(error)
    summary = process_one(run_dir, calibration, output, options | {"skip_bad_frames": True})
    left_out = f"Frames are left out, as by --skip-bad-frames of erlif process. {reason}"
    echo_aside(left_out)
    return f"{summary}\n{left_out}"


@contextmanager
def _ending(watched: Follower) -> Iterator[None]:
    """State on the page why there is no film."""
    try:
        yield
    except BaseException as error:
        reason = str(error) if isinstance(error, ErlifError) else "erlif watch was ended."
        watched.announce(f"There is no film: {reason}", closed=True, failed=True)
        raise


@contextmanager
def _show_page(
    source: Watch | SetupWatch, *, page: str, port: int, browser: bool
) -> Iterator[None]:
    """Serve the page of a run, and open it in the browser."""
    from erlif.show.view.live import live_page

    with ExitStack() as opened:
        address = opened.enter_context(live_page(source, page=page, port=port))
        click.echo(f"The page is at {address}\nCtrl-C ends the recording.")
        if browser:
            webbrowser.open(opened.enter_context(leading_to(address)).as_uri())
        yield


def _follow_setup(trials: SetupWatch) -> None:
    """Print the advice whenever it changes, until Ctrl-C."""
    version, printed = -1, [""]
    try:
        while True:
            version = trials.wait(version, 1.0)
            advice = trials.news(version - 1, 0, 0, 0.0)["advice"]
            if advice != printed:
                click.echo("; ".join(advice) or "nothing to turn")
                printed = advice
    except EndedBySignal:
        raise
    except KeyboardInterrupt:
        pass


def _follow(watched: Watch, quiet: float | None, on_alarm: str | None) -> None:
    """Print a line each second while pairs come, until the recording ends."""
    printed, line = 0.0, ""
    known: set[str] = set()
    reported: set[str] = set()

    def report(state: WatchState) -> None:
        """Print alarms and faults that are new, and run the command of an alarm."""
        nonlocal known, reported
        for name in state.alarms.keys() - known:
            echo_aside(f"ALARM {state.alarms[name]}")
            if on_alarm:
                _start(on_alarm)
        # a fault that lasts is printed again where another file or frame has joined it
        faults = {re.sub(r"\d+", "", text): text for text in state.faults.values()}
        for text in faults.keys() - reported:
            echo_aside(faults[text])
        known, reported = set(state.alarms), set(faults)

    try:
        while not watched.is_quiet(quiet):
            time.sleep(_LOOK)
            state = watched.state()
            report(state)
            if time.monotonic() - printed > _EVERY and _line(state) != line:
                line, printed = _line(state), time.monotonic()
                click.echo(line)
    except EndedBySignal:
        raise
    except KeyboardInterrupt:  # the end of the recording, not of the command
        pass

    # what was measured since the last look
    state = watched.state()
    report(state)
    click.echo(_line(state))


def _start(text: str) -> None:
    """Run a command of the user beside the watch."""
    Thread(target=subprocess.run, args=(text,), kwargs={"shell": True}, daemon=True).start()


def _line(state: WatchState) -> str:
    """The state in one line."""
    if state.latest is None:
        return f"{count_of(state.arrived, 'pair')}, none measured yet"
    one = state.latest
    return (
        f"pair {one.place}: min {one.film_min:.2f} ± {one.film_min_std:.2f} um, mean "
        f"{one.film_mean:.2f} ± {one.film_mean_std:.2f} um, light {one.light[0]:.0f}/"
        f"{one.light[1]:.0f} DN, {len(state.measured)}/{state.arrived} measured"
    )
