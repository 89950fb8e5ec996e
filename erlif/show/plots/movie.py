"""A movie of the cycle: the map, the mechanism, and the film against the angle of the drive."""

from __future__ import annotations

import io
import shutil
import subprocess
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from PIL import Image

from erlif.core.errors import OutputError
from erlif.core.progress import ShowProgress, choose_progress
from erlif.io.files import describe_trigger, expect_folder, open_film, refuse_existing, write_file
from erlif.show.plots import maps
from erlif.show.plots import style as looks
from erlif.show.plots.kinematics import film_over_cycle
from erlif.show.plots.maps import joint_image, thin_map
from erlif.show.plots.mechanism import MechanismView, draw_mechanism
from erlif.show.plots.sheet import sheet_groups
from erlif.show.plots.style import MEAN, MUTED, OUTWARD, RETURN, AnyFigure, pt, styled
from erlif.show.plots.triggers import choose_abscissa

# Frames of a movie at most; of more triggers, evenly chosen ones are shown.
MOST_FRAMES = 60

_WIDTH = 960  # pixels of a frame
_MAP = 0.46  # width of the map in the figure
_AROUND = 1.0  # inch above and below the map
_LEAST = 2.6  # inch, height of a frame
_COLOURS, _FADES = 176, 16  # of a GIF: colours of maps, and of each colour of lines
_SPEED = (0.1, 60.0)  # fewest and most frames per second


@dataclass(frozen=True)
class CycleView:
    """A frame of the movie, which `show` moves to another trigger.

    Attributes
    ----------
    film : Dataset
        The film, whose maps are read one by one.
    figure : Figure
        The frame.
    image : AxesImage
        The map at the current trigger, thinned.
    marker : Line2D
        Line at the current angle.
    mechanism : MechanismView or None
        The mechanism, where there is one.
    """

    film: xr.Dataset
    figure: AnyFigure
    image: AxesImage
    marker: Line2D
    mechanism: MechanismView | None

    def show(self, trigger: int) -> None:
        """Move to a trigger.

        Parameters
        ----------
        trigger : int
            Number of the trigger, counted from 0.
        """
        self.image.set_data(thin_map(self.film, trigger))
        self.image.axes.set_title(describe_trigger(self.film, trigger))
        x = float(choose_abscissa(self.film).values[trigger])
        self.marker.set_xdata([x, x])
        if self.mechanism is not None:
            self.mechanism.show(trigger)


def order_of_cycle(film: xr.Dataset) -> list[int]:
    """Triggers of a movie in the order of the cycle, outward stroke first.

    Arguments as in `erlif.plots`.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> order_of_cycle(example_film())
    [0, 1, 2, 3, 4, 5]
    """
    return [int(k) for _, members in sheet_groups(film) for k in members]


@styled
def cycle_view(film: xr.Dataset, *, trigger: int, figure: AnyFigure | None = None) -> CycleView:
    """Draw one frame of the movie of a cycle. Arguments as in `erlif.plots`.

    Returns
    -------
    CycleView
        Its `figure` holds the map with its colour bar, the mechanism where there is one, and the
        film against the angle of the drive.

    Examples
    --------
    >>> from erlif.show.plots import example_film
    >>> view = cycle_view(example_film(), trigger=1)
    >>> view.show(2)
    >>> view.image.axes.get_title()[:11]
    'trigger 2, '
    """
    chosen, total = order_of_cycle(film), film.sizes["trigger"]
    more = "" if len(chosen) == total else f"{len(chosen)} of {total} triggers"
    sizes = {"width": _MAP, "around": _AROUND, "least": _LEAST}
    figure = maps.figure_of_maps(figure, film, more=more, **sizes)
    panels = figure.subplot_mosaic("am;af", width_ratios=(1.2, 1), height_ratios=(1, 1.3))
    mechanism = draw_mechanism(film, trigger=trigger, ax=panels["m"])
    if mechanism is None:
        panels["m"].remove()

    limits = maps.common_limits(film, chosen[:: max(1, len(chosen) // 12)])
    ax = panels["a"]
    image = joint_image(ax, film, thin_map(film, trigger), limits)
    looks.add_colour_bar(image, ax, "film thickness [µm]\ngrey: flagged")

    film_over_cycle(film, ax=panels["f"])
    marker = panels["f"].axvline(0.0, color=RETURN, linewidth=pt(1.2), zorder=4)
    view = CycleView(film, figure, image, marker, mechanism)
    view.show(trigger)
    return view


def cycle_movie(
    film: xr.Dataset | str | Path,
    path: str | Path,
    *,
    frames_per_second: float = 10.0,
    style: str | Path | None = None,
    overwrite: bool = False,
    progress: ShowProgress = None,
) -> Path:
    """Write a movie of the cycle as GIF or MP4.

    Each frame is one trigger, and all are shown for the same time: the map, the mechanism in its
    true position with the direction of its motion, and the film against the angle of the drive.
    With more than sixty triggers, sixty evenly chosen ones are shown and the frames state it; maps
    of 480 pixels and more are thinned. The same film gives the same file.
    Arguments that are not listed are those of `write_figures`.

    Parameters
    ----------
    film : xarray.Dataset or path
        As `erlif.process` returns it, or its file.
    path : path
        ``.gif``, or ``.mp4`` where the program ffmpeg is installed.
    frames_per_second : float
        From 0.1 to 60.
    overwrite : bool
        Replace an existing file.
    progress : callable, bool or "bar"
        Called with ``"movie"``, the number of frames that are drawn, and of all; "bar" shows a bar.

    Returns
    -------
    Path
        The movie, complete.

    Raises
    ------
    OutputError
        If the file exists, its suffix or the speed is another one, or ffmpeg is missing.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> from erlif.show.plots import example_film
    >>> film = example_film().isel(trigger=[0, 1])
    >>> with TemporaryDirectory() as directory:
    ...     movie = cycle_movie(film, f"{directory}/cycle.gif")
    ...     movie.read_bytes()[:6]
    b'GIF89a'
    """
    path = Path(path)
    check_movie(path, frames_per_second, (".gif", ".mp4"))
    refuse_existing(path, overwrite=overwrite)
    opened = nullcontext(film) if isinstance(film, xr.Dataset) else open_film(film)
    with opened as shown, looks.in_style(style):
        expect_folder(path)
        chosen = order_of_cycle(shown)
        view = cycle_view(shown, trigger=chosen[0])
        pictures = draw_pictures(view.figure, view.show, chosen, progress)
    return write_pictures(pictures, path, frames_per_second)


def check_movie(path: Path, speed: float, suffixes: Sequence[str]) -> None:
    """Refuse a movie of another format or speed, and MP4 without the program that encodes it."""
    if path.suffix not in suffixes:
        raise OutputError(
            f"Expected a name in {' or '.join(suffixes)} for the movie; got {path.name}. Name it "
            "so."
        )
    if not _SPEED[0] <= speed <= _SPEED[1]:
        raise OutputError(
            f"Expected a movie of {_SPEED[0]:g} to {_SPEED[1]:g} frames per second; got {speed:g}. "
            "Choose a speed between them."
        )
    if path.suffix == ".mp4" and shutil.which("ffmpeg") is None:
        raise OutputError(
            "Expected the program ffmpeg for a movie in MP4; it is not installed. Install it, or "
            "write a GIF with a name that ends in .gif."
        )


def write_pictures(frames: list[Image.Image], path: Path, speed: float) -> Path:
    """Write pictures as the movie that the suffix of `path` names, whole or not at all."""
    encode = _encode_mp4 if path.suffix == ".mp4" else _encode_gif
    return write_file(path, encode(frames, speed))


_Place = TypeVar("_Place", int, float)


@styled
def draw_pictures(
    figure: AnyFigure,
    show: Callable[[_Place], None],
    places: Sequence[_Place],
    progress: ShowProgress = None,
) -> list[Image.Image]:
    """Draw a figure at each place that `show` moves it to, with one layout."""
    report = choose_progress(progress)
    canvas = FigureCanvasAgg(looks.fix_layout(figure))
    canvas.figure.set_dpi(_WIDTH / canvas.figure.get_figwidth())
    pictures = []
    for n, place in enumerate(places):
        report("movie", n, len(places))
        show(place)
        canvas.draw()  # type: ignore[no-untyped-call]
        picture = np.asarray(canvas.buffer_rgba())[:, :, :3]  # type: ignore[no-untyped-call]
        # encoders of video take even numbers of rows and columns
        rows, columns = (size - size % 2 for size in picture.shape[:2])
        pictures.append(Image.fromarray(np.ascontiguousarray(picture[:rows, :columns])))
    report("movie", len(places), len(places))
    return pictures


def _palette() -> bytes:
    """Colours of a GIF: those of the maps, greys, and lines on white."""
    batlow = looks.colour_map("batlow")(np.linspace(0, 1, _COLOURS))[:, :3]
    fades = np.linspace(0, 1, _FADES)[:, None]
    names = ("black", MEAN, RETURN, OUTWARD, MUTED)
    lines = [np.array(to_rgb(name)) * fades + (1 - fades) for name in names]
    return bytes(np.rint(255 * np.concatenate([batlow, *lines])).astype(np.uint8))


def _encode_gif(frames: list[Image.Image], speed: float) -> bytes:
    """Encode pictures as a GIF that repeats, with one palette, so that nothing flickers."""
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    mapped = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]

    content = io.BytesIO()
    options: dict[str, Any] = {"duration": round(1000 / speed), "loop": 0, "comment": b"erlif"}
    mapped[0].save(content, format="GIF", save_all=True, append_images=mapped[1:], **options)
    return content.getvalue()


def _encode_mp4(frames: list[Image.Image], speed: float) -> bytes:
    """H.264 in the form that browsers take; one thread and no dates, so the same every time."""
    width, height = frames[0].size
    command = ["ffmpeg", "-hide_banner", "-loglevel", "error", "-y"]
    command += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}"]
    command += ["-r", f"{speed:g}", "-i", "-", "-an", "-c:v", "libx264", "-pix_fmt", "yuv420p"]
    command += ["-crf", "20", "-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact"]
    command += ["-metadata", "comment=erlif", "-movflags", "frag_keyframe+empty_moov"]
    pixels = b"".join(frame.tobytes() for frame in frames)
    done = subprocess.run([*command, "-f", "mp4", "-"], input=pixels, capture_output=True)
    if done.returncode != 0 or not done.stdout:
        reason = done.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["no reason"]
        raise OutputError(
            f"Expected ffmpeg to encode the movie; it gave: {reason[0]}. Install an ffmpeg with "
            "libx264, or write a GIF with a name that ends in .gif."
        )
    return done.stdout
