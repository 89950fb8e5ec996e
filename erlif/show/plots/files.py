"""The set of figures of a film, and their files."""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from erlif.calibration import Calibration, Profile, calibration_of, open_calibration, read_profile
from erlif.core.errors import ErlifError, OutputError
from erlif.core.progress import ShowProgress, choose_progress
from erlif.io import files as stored
from erlif.io.ingest.containment import refuse_outside
from erlif.io.settings import CrankRockerSettings, read_fixture_settings, read_run_settings
from erlif.pipeline import calibrate, restore_images
from erlif.show.plots import style as looks
from erlif.show.plots.bore import film_along_axis
from erlif.show.plots.calibration import calibration_figure, fixture_profile, profile_figure
from erlif.show.plots.images import band_images_figure, ratio_image
from erlif.show.plots.kinematics import cycle_figure, speed_against_angle
from erlif.show.plots.maps import image_height, thickness_figure
from erlif.show.plots.naming import run_line, write_title
from erlif.show.plots.orbit import has_position, pin_figure
from erlif.show.plots.prediction import has_prediction, prediction_figure, prediction_map_figure
from erlif.show.plots.registration import registration_figure
from erlif.show.plots.sheet import map_sheet_figure
from erlif.show.plots.stribeck import stribeck_figure
from erlif.show.plots.style import ONE_COLUMN, AnyFigure, new_figure, styled
from erlif.show.plots.trend import speed_figure, speed_over_load
from erlif.show.plots.triggers import has_varying_speed
from erlif.trend import place_of_minimum

logger = logging.getLogger(__name__)

_KINDS = ("png", "pdf", "svg")
_DPI = (20, 2400)  # fewest and most pixels per inch
_RATIO_WIDTH = 0.65  # of a column, for the image of the ratio
_LABELS = 0.75  # inch above and below the image of the ratio, for title and labels
_LEAST_SPAN = 0.1  # relative range of speed over load below which it shows no trend
_SAME = 1e-9  # relative difference of parameters that a text file of them may leave


def find_run(film_path: Path, film: xr.Dataset, *, allow_outside: bool = False) -> Path | None:
    """Find the run directory of a film.

    Parameters
    ----------
    film_path : Path
        The file of the film.
    film : xarray.Dataset
        The film.
    allow_outside : bool
        As for `erlif.io.settings.read_run_settings`.

    Returns
    -------
    Path or None
        The directory of the film if its run.toml has the name of the run.

    Examples
    --------
    A directory without run.toml is not a run directory:

    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_film
    >>> with TemporaryDirectory() as directory:
    ...     find_run(Path(directory) / "film.nc", example_film()) is None
    True
    """
    # another run.toml can lie beside a film that was moved; the name of the run decides
    beside = film_path.parent
    try:
        settings = read_run_settings(beside, allow_outside=allow_outside)
    except ErlifError:
        return None
    return beside if settings.name == stored.settings_of(film).name else None


def find_fixture(film: xr.Dataset, run_dir: Path | None) -> Path | None:
    """Find the fixture directory of a film.

    Parameters
    ----------
    film : xarray.Dataset
        The film.
    run_dir : Path or None
        Its run directory, from `find_run`.

    Returns
    -------
    Path or None
        The directory of the calibration in run.toml if it holds fixture.toml.

    Examples
    --------
    The settings of this film name no calibration:

    >>> from erlif.show.plots import example_film
    >>> find_fixture(example_film(), Path("run")) is None
    True
    """
    named = stored.settings_of(film).calibrations
    if not named or run_dir is None:
        return None
    directory = (run_dir / named[0]).parent
    return directory if (directory / "fixture.toml").is_file() else None


@dataclass(frozen=True)
class FigureSource:
    """A film, and the directories it was made from as far as they are at hand.

    Attributes
    ----------
    film_path : Path
        The file of the film.
    film : xr.Dataset
        The film.
    trigger : int
        Trigger of the figures that show a single one.
    run_dir : Path | None
        The run directory.
    fixture_dir : Path | None
        The fixture directory.
    allow_outside : bool
        Whether links and names of files that leave the run directory are followed.
    """

    film_path: Path
    film: xr.Dataset
    trigger: int
    run_dir: Path | None
    fixture_dir: Path | None
    allow_outside: bool = False
    _groups: dict[str, xr.Dataset] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def images(self) -> xr.Dataset:
        """Images behind the map of the trigger; raises ErlifError."""
        assert self.run_dir is not None
        options: dict[str, Any] = {"trigger": self.trigger, "allow_outside": self.allow_outside}
        return restore_images(self.film_path, self.run_dir, **options)

    @cached_property
    def calibration(self) -> Calibration:
        """The calibration, with its points if file or fixture are at hand and are of the film."""
        kept = calibration_of(self.film).calibration
        named = stored.settings_of(self.film).calibrations
        files = [] if self.run_dir is None else [self.run_dir / name for name in named[:1]]
        if self.fixture_dir is not None:
            files.append(self.fixture_dir / "calibration.nc")
        made: list[tuple[Path, Callable[[], Calibration]]] = [
            (path, partial(open_calibration, path)) for path in files if path.is_file()
        ]
        # that of a fixture outside the run directory is not kept in a file
        if not made and self.fixture_dir is not None:
            fit = partial(calibrate, self.fixture_dir, allow_outside=self.allow_outside)
            made.append((self.fixture_dir, fit))

        for place, make in made:
            try:
                found = make()
            except ErlifError as error:
                logger.warning("%s", error)
                continue
            one, other = found.parameters, kept.parameters
            if one.size == other.size and np.allclose(one, other, rtol=_SAME):
                return found
            # a calibration that was made again since is not the one of the film
            logger.warning(
                "%s is not the calibration that the film was made with; its points are not drawn",
                place,
            )
        return kept

    @cached_property
    def fixture(self) -> tuple[str, Profile]:
        """Name and CMM profile of the fixture; raises ErlifError."""
        assert self.fixture_dir is not None
        fixture = read_fixture_settings(self.fixture_dir).fixture
        if not self.allow_outside:
            refuse_outside(self.fixture_dir, [fixture.profile])
        return fixture.name, read_profile(self.fixture_dir / fixture.profile)

    def group(self, name: str) -> xr.Dataset:
        """Read a group of the film into memory, once."""
        if name not in self._groups:
            with stored.open_film(self.film_path, group=name) as group:
                self._groups[name] = group.load()
        return self._groups[name]


@styled
def _draw_panel(source: FigureSource, draw: Callable[..., Any], **options: Any) -> AnyFigure:
    figure = new_figure(named=source.film)
    draw(source.film, ax=figure.add_subplot(), **options)
    return figure


@styled
def _draw_fixture(source: FigureSource) -> AnyFigure:
    name, profile = source.fixture
    if profile.position.ndim == 2:
        figure = new_figure()
        fixture_profile(profile, calibration=source.calibration, ax=figure.add_subplot())
    else:
        figure = profile_figure(profile, calibration=source.calibration)
    write_title(figure, name if "fixture" in name.lower() else f"fixture {name}")
    return figure


@styled
def _draw_ratio(source: FigureSource) -> AnyFigure:
    height = image_height(source.film, _RATIO_WIDTH * ONE_COLUMN) + _LABELS
    figure = new_figure(ONE_COLUMN, height, text=_LABELS)
    ratio_image(source.images, source.film, ax=figure.add_subplot())
    lines = run_line(source.film), stored.describe_trigger(source.film, source.trigger)
    write_title(figure, "\n".join(filter(None, lines)))
    return figure


# The figures of a film, in the order of the method.
DRAWN: dict[str, Callable[[FigureSource], AnyFigure]] = {
    "speed_against_angle": lambda source: _draw_panel(source, speed_against_angle),
    "fixture_profile": _draw_fixture,
    "processed_images": lambda source: band_images_figure(
        source.images, source.film, trigger=source.trigger
    ),
    "ratio_image": _draw_ratio,
    "calibration": lambda source: calibration_figure(source.calibration),
    "thickness_map": lambda source: thickness_figure(source.film, trigger=source.trigger),
    "film_along_axis": lambda source: _draw_panel(source, film_along_axis, trigger=source.trigger),
    "film_against_speed": lambda source: speed_figure(source.film),
    "stribeck": lambda source: stribeck_figure(source.film),
    "map_sheet": lambda source: map_sheet_figure(source.film),
    "map_sheet_less_gap": lambda source: map_sheet_figure(source.film, less_gap=True),
    "film_over_cycle": lambda source: cycle_figure(source.film),
    "film_and_prediction": lambda source: prediction_figure(source.film, source.group("frames")),
    "prediction_map": lambda source: prediction_map_figure(source.film, trigger=source.trigger),
    "pin_orbit": lambda source: pin_figure(source.film),
    "registration": lambda source: registration_figure(
        source.group("registration"), source.group("frames"), film=source.film
    ),
}


def figures_of(film: xr.Dataset) -> list[str]:
    """Names of the figures of a film: one along the axis where the bore is not straight."""
    joint = stored.settings_of(film).joint
    shaped = joint is not None and joint.bore is not None
    return [name for name in DRAWN if shaped or name != "film_along_axis"]


def reason_missing(name: str, source: FigureSource) -> str | None:
    """State why a figure cannot be drawn; None if it can."""
    if name in ("processed_images", "ratio_image"):
        if source.run_dir is None:
            return "it needs the frames, and the run directory is neither given nor beside the film"
        # only the attempt shows whether the frames can be read; the images are kept for drawing
        try:
            source.images  # noqa: B018
        except (ErlifError, OSError) as error:
            return f"the frames could not be read again: {error}"

    if name == "speed_against_angle" and not has_varying_speed(source.film):
        return _describe_steady(source.film)
    if name not in figures_of(source.film):
        return "run.toml has no bore in [joint]: it is straight"
    if name == "film_along_axis" and place_of_minimum(source.film, trigger=source.trigger) is None:
        return "the trigger has no minimum film"
    if name == "film_over_cycle" and source.film.sizes["trigger"] < 2:
        return "the film has a single trigger"
    if name == "pin_orbit" and not has_position(source.film):
        return "the film has no position of a pin at two triggers; it needs [joint]"
    if name in ("film_and_prediction", "prediction_map") and not has_prediction(source.film):
        return _reason_without_prediction(source.film)
    if name == "film_and_prediction" and "elapsed_cycles" not in source.group("frames"):
        return "the film has no turns of the crank at its frames"
    if name == "stribeck" and "friction_coefficient" not in source.film:
        return "the film has no friction of a joint; it needs [joint], [oil], speed and load"
    if name == "film_against_speed":
        return _reason_without_trend(source.film)

    if name == "fixture_profile":
        if source.fixture_dir is None:
            return (
                "it needs the CMM profile, and the fixture directory is neither given nor where "
                "run.toml names it"
            )
        try:
            source.fixture  # noqa: B018
        except ErlifError as error:
            return str(error)
    return None


def _reason_without_prediction(film: xr.Dataset) -> str:
    """State why a film has no transient prediction."""
    settings = stored.settings_of(film)
    if not isinstance(settings.mechanism, CrankRockerSettings):
        return "a transient film is predicted for the joint of a crank-rocker alone"
    lacking = [f"[{name}]" for name in ("joint", "oil") if getattr(settings, name) is None]
    if lacking:
        return f"run.toml has no {' and no '.join(lacking)}, which the prediction needs"
    return "the prediction failed; a note of the film states the reason (erlif process -v)"


def _describe_steady(film: xr.Dataset) -> str:
    """State why there is no figure of the speed."""
    if "sliding_speed" not in film:
        return "the film has no speed"
    speed = 1e3 * float(film.sliding_speed[0])
    return f"the sliding speed is the same at all triggers to 1 %, {speed:.4g} mm/s"


def _reason_without_trend(film: xr.Dataset) -> str | None:
    """State why the film cannot be drawn against speed over load; None if it can."""
    if "speed_exponent" not in film:
        lacking = [] if "joint_load" in film else ["load"]
        if "rocker_speed" not in film and "sliding_speed" not in film:
            lacking = ["speed", *lacking]
        return f"the film has no {' and no '.join(lacking)}"
    x = speed_over_load(film)
    if x.max() < (1 + _LEAST_SPAN) * x.min():
        return f"speed over load varies by less than {_LEAST_SPAN:.0%}"
    return None


def missing_figures(
    film_path: str | Path,
    *,
    run_dir: str | Path | None = None,
    fixture_dir: str | Path | None = None,
) -> dict[str, str]:
    """List the figures that `write_figures` would leave out.

    Parameters
    ----------
    film_path, run_dir, fixture_dir
        As for `write_figures`.

    Returns
    -------
    dict of str to str
        Name of each missing figure, and the reason.

    Raises
    ------
    ErlifError
        If there is no such film.

    Examples
    --------
    A film without its run directory:

    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import write_example
    >>> with TemporaryDirectory() as directory:
    ...     list(missing_figures(write_example(f"{directory}/film.nc")))
    ['fixture_profile', 'processed_images', 'ratio_image', 'stribeck']
    """
    with stored.open_film(film_path) as film:
        source = find_source(film_path, film, None, run_dir, fixture_dir)
        reasons = {name: reason_missing(name, source) for name in figures_of(film)}
    return {name: reason for name, reason in reasons.items() if reason is not None}


def find_source(
    film_path: str | Path,
    film: xr.Dataset,
    trigger: int | None,
    run_dir: str | Path | None,
    fixture_dir: str | Path | None,
    *,
    allow_outside: bool = False,
) -> FigureSource:
    """Find the directories a film was made from; raises ErlifError if it has no such trigger."""
    if trigger is None:
        trigger = stored.fastest_trigger(film)
    stored.check_trigger(film, trigger)
    path = Path(film_path)
    run = (
        Path(run_dir) if run_dir is not None else find_run(path, film, allow_outside=allow_outside)
    )
    fixture = find_fixture(film, run) if fixture_dir is None else Path(fixture_dir)
    return FigureSource(path, film, trigger, run, fixture, allow_outside)


def write_figures(
    film_path: str | Path,
    out_dir: str | Path,
    *,
    run_dir: str | Path | None = None,
    fixture_dir: str | Path | None = None,
    trigger: int | None = None,
    formats: Sequence[str] = ("png", "pdf"),
    only: Sequence[str] | None = None,
    dpi: float | None = None,
    style: str | Path | None = None,
    overwrite: bool = False,
    allow_outside: bool = False,
    progress: ShowProgress = None,
) -> list[Path]:
    """Write the figures of a film.

    A figure whose input is not at hand is left out with a warning in the log; `missing_figures`
    lists them beforehand. The look does not depend on settings of the caller, so that the same film
    gives the same files.

    Parameters
    ----------
    film_path : path
        ``film.nc`` or ``film.zarr``.
    out_dir : path
        Directory of the files; it is made if it does not exist.
    run_dir, fixture_dir : path, optional
        Directories of the frames and of the CMM profile. Default: the directory of the film, and
        the one that its run.toml names.
    trigger : int, optional
        Trigger of the figures that show a single one; default: the outward one of highest speed.
    formats : sequence of str
        Of ``"png"``, ``"pdf"`` and ``"svg"``.
    only : sequence of str, optional
        Names of the figures to write; default: all that the film has.
    dpi : float, optional
        Pixels per inch, from 20 to 2400; default: that of the style, which is 300 without one.
    style : str or path, optional
        ``"paper"``, ``"slides"``, or a style sheet of matplotlib; default: the look of erlif.
    overwrite : bool
        Replace existing files.
    allow_outside : bool
        Follow links and names of files that leave the run directory.
    progress : callable, bool or "bar"
        Called with ``"figures"``, the number of figures that are written, and of all; "bar" shows a
        bar.

    Returns
    -------
    list of Path
        The files, in the order of the method.

    Raises
    ------
    OutputError
        If a file exists or cannot be written, or a format, a style or a name of a figure is
        unknown, or a figure named by `only` cannot be drawn.
    ErlifError
        If the film has no such trigger.

    Examples
    --------
    >>> paths = write_figures("run/film.nc", "figures", formats=("pdf",))  # doctest: +SKIP

    Formats are checked before any figure is drawn:

    >>> write_figures("run/film.nc", "figures", formats=("gif",))
    Traceback (most recent call last):
    erlif.core.errors.OutputError: Expected figures as png, pdf, svg; got gif. Choose from these.
    """
    _refuse_unknown("figures as", formats, _KINDS)
    _refuse_unknown("names of figures among", only or (), DRAWN)
    if dpi is not None and not _DPI[0] <= dpi <= _DPI[1]:
        raise OutputError(
            f"Expected a resolution from {_DPI[0]} to {_DPI[1]} dpi; got {dpi:g}. Choose one."
        )

    report = choose_progress(progress)
    out_dir = Path(out_dir)
    written: list[Path] = []
    with stored.reading_film(film_path), stored.open_film(film_path) as film, looks.in_style(style):
        source = find_source(
            film_path, film, trigger, run_dir, fixture_dir, allow_outside=allow_outside
        )
        wanted = figures_of(film) if only is None else [name for name in DRAWN if name in only]
        reasons = {name: reason_missing(name, source) for name in wanted}
        names = [name for name, reason in reasons.items() if reason is None]
        if only is not None and len(names) < len(wanted):
            missing = next(name for name in wanted if name not in names)
            raise OutputError(
                f"Expected a film that has the figure {missing}: {reasons[missing]}. Name others, "
                "or none, to write what there is."
            )

        # a film that lacks a part is refused before the first figure is written
        if "registration" in names:
            _ = source.group("registration"), source.group("frames")
        if "calibration" in names:
            _ = source.calibration

        stored.expect_folder(out_dir)
        # an existing file is found before the first figure is written, not after the ninth
        for name in names:
            for kind in formats:
                stored.refuse_existing(out_dir / f"{name}.{kind}", overwrite=overwrite)
        for name, reason in reasons.items():
            if reason is not None:
                logger.warning("figure %s left out: %s", name, reason)

        stored.make_folder(out_dir)
        for n, name in enumerate(names):
            report("figures", n, len(names))
            figure = DRAWN[name](source)
            paths = [out_dir / f"{name}.{kind}" for kind in formats]
            written += [looks.save_figure(figure, path, dpi=dpi) for path in paths]
        report("figures", len(names), len(names))
    return written


def _refuse_unknown(what: str, names: Collection[str], known: Collection[str]) -> None:
    unknown = [name for name in names if name not in known]
    if unknown:
        raise OutputError(
            f"Expected {what} {', '.join(known)}; got {', '.join(unknown)}. Choose from these."
        )
