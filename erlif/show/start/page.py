"""The page of `erlif start`: what it reads, and what it sends."""

from __future__ import annotations

import json
import logging
import time
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager, suppress
from dataclasses import asdict
from functools import partial
from pathlib import Path
from threading import RLock
from typing import Any

import numpy as np

from erlif.calibration import Calibration, read_profile, save_calibration
from erlif.core.arrays import Mask
from erlif.core.errors import ErlifError
from erlif.core.flags import Flag
from erlif.core.notes import Note, remark
from erlif.core.progress import Progress
from erlif.core.units import parse_quantity
from erlif.io.ingest.containment import refuse_outside
from erlif.io.ingest.exclusions import fill_parts
from erlif.io.settings.reading import find_gaps
from erlif.pipeline.fixture import calibrate
from erlif.pipeline.run import process
from erlif.pipeline.watch.follow import as_plain
from erlif.pipeline.watch.setup import check_counts
from erlif.review.check import examine
from erlif.show.plots import write_calibration_figure
from erlif.show.report import describe_calibration, summarise_briefly
from erlif.show.start.brush import write_mask
from erlif.show.start.draft import KINDS, Draft
from erlif.show.start.folders import inside, list_folder, suggest
from erlif.show.start.frames import FrameSource, pitch_of
from erlif.show.start.work import Work
from erlif.show.view.films import FilmReader, open_films
from erlif.show.view.handlers import READING, WRITING
from erlif.show.view.layers import LAYERS, describe_layers
from erlif.show.view.queries import Found, Request, pack_values
from erlif.show.view.serving import require_library, serving

_CURVE = "calibration.png"  # the figure of a calibration, beside it

_logger = logging.getLogger(__name__)

_THREADS = 4  # that read frames and settings

# Numbers and brackets without end.
_TOO_MUCH = OverflowError, RecursionError

_MOST_POINTS = 400  # of a profile that is drawn over an image


class StartPage:
    """One page from folders of frames to a film.

    Parameters
    ----------
    root : Path
        The start directory: folders below it can be opened.

    Attributes
    ----------
    films : list[FilmReader]
        The film, once there is one.

    Raises
    ------
    ErlifError
        If the directory cannot be read.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self._suggested = suggest(self.root)
        self.films: list[FilmReader] = []
        self._draft, self._work, self._lock = Draft(), Work(), RLock()
        self._sources: dict[str, FrameSource] = {}

    def reading(self) -> dict[str, Callable[[Request], Found]]:
        """What the page asks for, by its name in the address; that of the viewer included."""
        return {
            **READING,
            "state": lambda request: self.describe(),
            "work": lambda request: self._describe_work(),
            "curve": lambda request: self._draft.path("fixture").with_name(_CURVE).read_bytes(),
            "frame": self._pack_frame,
            "levels": self._levels,
        }

    def writing(self) -> dict[str, Callable[[Any, bytes], Mapping[str, Any]]]:
        """What the page sends, by its name in the address."""
        actions: dict[str, Callable[[Mapping[str, Any]], Mapping[str, Any] | None]] = {
            "folders": lambda given: list_folder(self.root, str(given["folder"])),
            "open": self._open,
            "try": self._try,
            "change": lambda given: self._draft.change(given["name"], given["values"]),
            "brush": self._brush,
            "exchange": lambda given: self._draft.exchange(given["name"]),
            "undo": lambda given: self._draft.undo(),
            "start": self._start,
            "cancel": lambda given: self._work.cancel(),
        }

        def act(name: str, body: bytes) -> Mapping[str, Any]:
            try:
                given = json.loads(body)
                with self._lock:
                    return actions[name](given) or self.describe()
            except (ValueError, TypeError, KeyError, AttributeError, *_TOO_MUCH) as error:
                # a defect of erlif, if the page itself has sent this
                _logger.warning("%s has ended with an error", name, exc_info=error)
                raise ErlifError(f"Expected what the page sends to {name}. Reload it.") from error

        return WRITING | {name: lambda films, body, name=name: act(name, body) for name in actions}

    # folders and settings

    def describe(self) -> dict[str, Any]:
        """Everything that the page shows, but for images."""
        with self._lock:
            return {
                "root": str(self.root),
                "suggested": self._suggested,
                "files": {name: self._describe_file(name) for name in self._draft.directories},
                "changes": [
                    {"file": f"{step.name}.toml", "title": step.title, "lines": step.change.lines}
                    for step in self._draft.changes
                ],
                "work": self._describe_work(),
                **describe_layers([LAYERS[name] for name in ("camera1", "camera2")]),
            }

    def _describe_file(self, name: str) -> dict[str, Any]:
        """Settings, images and shapes of "run" or "fixture"."""
        draft, values = self._draft, self._usable(name)
        directory = draft.directories[name]
        images: dict[str, list[int]] = {}
        refusal = ""
        try:
            images = self._sources[name].count(values)
        except ErlifError as error:
            refusal = str(error)
        return {
            "folder": directory.relative_to(self.root).as_posix(),
            "file": f"{name}.toml",
            "text": draft.path(name).read_text(encoding="utf-8-sig"),
            "notes": [asdict(note) for note in draft.notes[name]],
            "fields": list(draft.fields(name)),
            "faults": [fault.text for fault in draft.faults(name, draft.values(name))],
            "images": images,
            "refusal": refusal,
            "pitch": pitch_of(values),
            "shapes": self._shapes(name, values),
        }

    def _shapes(self, name: str, values: Mapping[str, Any]) -> dict[str, Any]:
        """What is drawn over the images: region, patch, polygons, and the profile of a fixture."""
        thickness, fixture = values.get("thickness", {}), values.get("fixture", {})
        shapes = {
            "roi": thickness.get("roi"),
            "patch": values.get("reference", {}).get("region"),
            "exclude": thickness.get("exclude", []),
            "orientation": values.get("registration", {}).get("orientation"),
            "origin": fixture.get("origin"),
            "direction": parse_quantity(fixture.get("direction", "0 deg"), "rad"),
        }
        if "profile" in fixture:
            with suppress(ErlifError):
                directory = self._draft.directories[name]
                refuse_outside(directory, [fixture["profile"]])
                profile = read_profile(directory / fixture["profile"])
                some = slice(None, None, 1 + profile.thickness.size // _MOST_POINTS)
                shapes["profile"] = profile.position[some].tolist()
                shapes["thickness"] = profile.thickness[some].tolist()
        return shapes

    def _usable(self, name: str) -> dict[str, Any]:
        """Values of the file without gaps, faults, and tables of other files."""
        values = self._draft.values(name)
        faults = [fault.place for fault in self._draft.faults(name, values)]
        for place in (*find_gaps(values), *faults):
            part, inner = values, place
            while len(inner) > 1 and isinstance(part.get(inner[0]), dict):
                part, inner = part[inner[0]], inner[1:]
            # keys of a table may contradict; of a list with a fault nothing is used
            if inner and (len(place) > 1 or not isinstance(part.get(inner[0]), dict)):
                part.pop(inner[0], None)
        return {table: values[table] for table in values.keys() & KINDS[name].model_fields.keys()}

    def _open(self, given: Mapping[str, Any]) -> None:
        name, directory = str(given["name"]), inside(self.root, str(given["folder"]))
        kind, anew = str(given["kind"]), given.get("anew") is True
        self._draft.open(name, directory, kind=kind, anew=anew)
        self._sources[name] = FrameSource(directory)
        self._draft.link()
        if name == "run":
            self._open_film(directory / "film.nc")

    def _try(self, given: Mapping[str, Any]) -> dict[str, Any]:
        """What a change would do: its lines, and what cannot be used."""
        change, faults = self._draft.propose(given["name"], given["values"])
        return {"lines": change.lines, "faults": [fault.text for fault in faults]}

    def _brush(self, given: Mapping[str, Any]) -> None:
        """Write a mask from strokes, and exclude what is white in it."""
        name, width = str(given["name"]), float(given["width"])
        strokes = [[(float(x), float(y)) for x, y in stroke] for stroke in given["strokes"]]
        directory = self._draft.path(name).parent
        values = self._usable(name)
        shape = self._sources[name].read(values, 1, "frames", 0).counts.shape
        mask = write_mask(directory, strokes, width=width, shape=shape)
        exclude = values.get("thickness", {}).get("exclude", [])
        try:
            excluded = {"thickness.exclude": [*exclude, mask]}
            self._draft.change(name, excluded, made=[directory / mask])
        except ErlifError:
            (directory / mask).unlink()
            raise

    # images

    def _opened(self, request: Request) -> tuple[FrameSource, dict[str, Any]]:
        """The images that the page names, by its settings as they are now."""
        name = request.text("name")
        with self._lock:
            self._draft.path(name)  # refused where it is not open
            return self._sources[name], self._usable(name)

    def _pack_frame(self, request: Request) -> Found:
        """Counts of an image, flagged where they are at full scale; as `pack_map` packs them."""
        source, values = self._opened(request)
        camera = request.whole("camera")
        found = source.read(values, camera, request.text("purpose"), request.whole("number"))
        layer, (height, width) = LAYERS[f"camera{camera}"], found.counts.shape
        flags = np.where(found.counts >= found.full_scale, Flag.SATURATED, 0).astype(np.uint16)
        if camera == 1:
            flags[_find_excluded(source.directory, values, (height, width))] = Flag.MASKED
        about = {"text": found.title, "height": height, "width": width}
        return pack_values(request, layer, found.counts.astype(np.float32), flags, **about)

    def _levels(self, request: Request) -> dict[str, Any]:
        """Histogram, mean and saturation of an image of both cameras."""
        source, values = self._opened(request)
        levels = []
        for camera in (1, 2):
            found = source.read(values, camera, request.text("purpose"), request.whole("number"))
            levels.append(as_plain(check_counts(found.counts, found.full_scale)))
        return {"cameras": levels}

    # work

    def _start(self, given: Mapping[str, Any]) -> None:
        task, name = str(given["task"]), str(given["name"])
        directory = self._draft.path(name).parent
        options = {"skip_bad_frames": given.get("skip") is True}
        tasks: dict[str, Callable[..., list[Note]]] = {
            "check": partial(_check, fixture=name == "fixture"),
            "calibrate": _calibrate,
            "process": self._process,
        }
        work = tasks[task]
        self._work.start(task, lambda progress: work(directory, progress, options))

    def _process(self, run_dir: Path, progress: Progress, options: dict[str, Any]) -> list[Note]:
        output = run_dir / "film.nc"
        self._close_film()  # some systems replace no file that is open
        try:
            with process(
                run_dir, output=output, overwrite=True, progress=progress, **options
            ) as film:
                text = summarise_briefly(film)
        finally:
            self._open_film(output)  # an earlier one where the work has failed
        return [remark("", text), remark("written", str(output.relative_to(self.root)))]

    def _describe_work(self) -> dict[str, Any]:
        films = [str(film.path.relative_to(self.root)) for film in self.films]
        return self._work.describe() | {"film": next(iter(films), None)}

    def _open_film(self, path: Path) -> None:
        """Show a film in the viewer, where there is one, in place of any other."""
        with self._lock:
            self._close_film()
            if path.exists():
                with suppress(ErlifError):
                    self.films += open_films([path], [])

    def _close_film(self) -> None:
        with self._lock:
            while self.films:
                self.films.pop().close()

    def close(self) -> None:
        """Cancel the work, wait for its end, and release the film."""
        self._work.cancel()
        self._work.wait()
        self._close_film()


def _find_excluded(directory: Path, values: Mapping[str, Any], shape: tuple[int, int]) -> Mask:
    """Pixels of camera 1 that the settings exclude; none where a part cannot be used."""
    parts, pitch = values.get("thickness", {}).get("exclude", []), pitch_of(values)
    with suppress(ErlifError):
        # polygons in mm wait for the scale
        parts = [one for one in parts if pitch or isinstance(one, str)]
        refuse_outside(directory, [one for one in parts if isinstance(one, str)])
        return fill_parts(directory, parts, shape, pitch=pitch or np.nan)
    return np.zeros(shape, bool)


def _check(
    directory: Path, progress: Progress, options: dict[str, Any], *, fixture: bool
) -> list[Note]:
    return examine(directory, fixture=fixture, progress=progress, **options).notes


def _calibrate(directory: Path, progress: Progress, options: dict[str, Any]) -> list[Note]:
    calibration: Calibration = calibrate(directory, progress=progress, **options)
    output = directory / "calibration.nc"
    save_calibration(calibration, output, overwrite=True)
    figure = write_calibration_figure(calibration, directory / _CURVE)
    text = describe_calibration(calibration)
    return [remark("", text), remark("written", f"{output.name}, {figure.name}")]


@contextmanager
def start_page(root: Path, *, port: int = 0) -> Iterator[str]:
    """Serve the page while the block runs.

    Parameters
    ----------
    root : Path
        As for `StartPage`.
    port : int
        Port on 127.0.0.1; 0 takes a free one.

    Yields
    ------
    str
        Address of the page, the token included.

    Raises
    ------
    ErlifError
        If the directory cannot be read, the port is taken, or the packages are missing.

    Examples
    --------
    >>> from urllib.request import urlopen
    >>> with start_page(Path("calibration")) as address, urlopen(f"{address}state") as reply:
    ...     json.load(reply)["suggested"]
    {'fixture': 'wedge'}
    """
    require_library()
    page = StartPage(root)
    shared = {"page": "start.html", "reading": page.reading(), "writing": page.writing()}
    with (
        closing(page),
        ThreadPoolExecutor(_THREADS) as executor,
        serving(port=port, films=page.films, executor=executor, **shared) as address,
    ):
        yield address


def serve_start(root: Path, *, port: int = 0, ready: Callable[[str], None] = print) -> None:
    """Serve the page until it is interrupted; arguments and errors as for `start_page`.

    `ready` receives the address.

    Examples
    --------
    >>> serve_start(Path("no such folder"))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
        ...
    erlif.core.errors.ErlifError: Expected a folder below ...
    """
    with start_page(root, port=port) as address:
        ready(address)
        while True:
            time.sleep(1.0)
