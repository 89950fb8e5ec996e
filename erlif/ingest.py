"""A run or fixture directory, as the rig wrote it, to counts of both cameras and an encoder log.

Opening a directory reads every header and the whole log, so that what does not fit together is refused before anything is
computed; the frames themselves are read pair by pair when a stage asks for them.
"""

from __future__ import annotations

import csv
import hashlib
import math
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import tifffile
import xarray as xr

from erlif.config import CameraSettings, FixtureSettings, RunSettings, read_fixture_settings, read_run_settings
from erlif.core.errors import EncoderError, FrameError
from erlif.core.products import EncoderLog, Frames

Counts = npt.NDArray[np.uint16]

_TIFF = {".tif", ".tiff"}
_KNOWN_COLUMNS = {
    "angle_deg": ("angle", "degree", "encoder angle"),
    "time_s": ("time", "s", "time of the trigger"),
    "load_N": ("load", "N", "load on the joint"),
    "temperature_C": ("temperature", "degree_Celsius", "temperature of the oil"),
}


@dataclass(frozen=True)
class Page:
    """One image in a file."""

    path: Path
    index: int

    @property
    def name(self) -> str:
        """File name, with the page where the file has several."""
        return self.path.name if self.index == 0 else f"{self.path.name}[{self.index}]"


@dataclass(frozen=True)
class Recording:
    """Two cameras' frames, paired, with the settings they were taken under.

    Attributes
    ----------
    directory : Path
    settings : RunSettings or FixtureSettings
    pages : tuple of two tuples of Page
        Frame k of camera 1 and frame k of camera 2 saw the same laser pulse.
    shape : (rows, columns)
    log : EncoderLog or None
        Row k belongs to frame k; None for a fixture.
    skipped : dict of int to str
        Frame pairs left out, with the reason.
    """

    directory: Path
    settings: RunSettings | FixtureSettings
    pages: tuple[tuple[Page, ...], tuple[Page, ...]]
    shape: tuple[int, int]
    log: EncoderLog | None = None
    skipped: dict[int, str] = field(default_factory=dict)

    @property
    def cameras(self) -> tuple[CameraSettings, CameraSettings]:
        """Settings of camera 1 and camera 2."""
        return self.settings.camera1, self.settings.camera2

    @property
    def frames(self) -> list[int]:
        """Numbers of the frame pairs that can be used."""
        return [k for k in range(len(self.pages[0])) if k not in self.skipped]


def open_run(run_dir: Path, *, skip_bad_frames: bool = False) -> Recording:
    """Open a run directory: settings, both cameras' files and the encoder log, checked against one another.

    Parameters
    ----------
    run_dir : Path
        Directory with ``run.toml``.
    skip_bad_frames : bool
        Leave out frame pairs with an unreadable file instead of refusing the run.

    Raises
    ------
    ConfigError, FrameError, EncoderError
        If settings, frames or log cannot be used or do not belong together.
    """
    settings = read_run_settings(run_dir)
    pages, shape, skipped = _pair_cameras(run_dir, settings, skip_bad_frames=skip_bad_frames)
    log = read_encoder_log(run_dir / settings.encoder.file)
    rows, frames = log.sizes["frame"], len(pages[0])
    if rows != frames:
        log_name = settings.encoder.file
        extra = (
            f"row {frames + 2} (frame {int(log.number[frames])}) of {log_name} is the first without a frame"
            if rows > frames
            else f"{pages[0][rows].name} is the first without a row"
        )
        raise EncoderError(
            f"Expected one row of {log_name} per frame; {log_name} has {rows} rows, the cameras have {frames} frames each: "
            f"{extra}. To drop one, delete that row, or move that frame of both cameras out of their folders."
        )
    return Recording(run_dir, settings, pages, shape, log, skipped)


def open_fixture(fixture_dir: Path, *, skip_bad_frames: bool = False) -> Recording:
    """Open a fixture directory; parameters and errors as for `open_run`, without a log."""
    settings = read_fixture_settings(fixture_dir)
    pages, shape, skipped = _pair_cameras(fixture_dir, settings, skip_bad_frames=skip_bad_frames)
    return Recording(fixture_dir, settings, pages, shape, None, skipped)


def read_frames(recording: Recording, frames: Sequence[int]) -> Frames:
    """Read frame pairs.

    Parameters
    ----------
    recording : Recording
    frames : sequence of int
        Frame numbers, counted from 0.

    Returns
    -------
    Frames
        counts (camera, frame, y, x) [DN].

    Raises
    ------
    FrameError
        If a file cannot be decoded, or counts do not fit the camera's bit depth.
    """
    counts = np.empty((2, len(frames), *recording.shape), np.uint16)
    for camera, (pages, settings) in enumerate(zip(recording.pages, recording.cameras, strict=True)):
        for n, k in enumerate(frames):
            counts[camera, n] = _read_page(pages[k], recording.directory)
            _check_full_scale(counts[camera, n], settings, pages[k])
    return Frames(
        xr.Dataset(
            {"counts": (("camera", "frame", "y", "x"), counts, {"units": "DN", "long_name": "raw counts"})},
            {"camera": [1, 2], "frame": np.asarray(frames, np.int64)},
        )
    )


def find_reference_pages(directory: Path, pattern: str, *, what: str) -> list[Page]:
    """Find the pages of a dark or flat recording and check their headers; raises FrameError."""
    pages, faults = _find_pages(directory, pattern, what)
    if faults:
        raise FrameError(_fault_message(faults, what))
    return [page for page, _ in pages]


def read_reference(page: Page, settings: CameraSettings, *, directory: Path, shape: tuple[int, int]) -> Counts:
    """Read one dark or flat page and check its size and counts; raises FrameError."""
    counts = _read_page(page, directory)
    if counts.shape != shape:
        raise FrameError(
            f"Darks and flats must have the size of the frames, {_size(shape)}; {page.name} is {_size(counts.shape)}. "
            "Record them with the same region of interest."
        )
    _check_full_scale(counts, settings, page)
    return counts


def hash_inputs(recording: Recording) -> dict[str, str]:
    """SHA-256 of every input by its name in the settings; the files of one pattern share one hash."""
    settings = recording.settings
    names: list[str] = []
    if isinstance(settings, RunSettings):
        names += ["run.toml", settings.encoder.file]
    else:
        names += ["fixture.toml", settings.fixture.profile]
    hashes = {name: _hash_files([recording.directory / name]) for name in names}
    for camera, pages in zip(recording.cameras, recording.pages, strict=True):
        hashes[camera.files] = _hash_files(sorted({page.path for page in pages}, key=natural_key))
        for reference in (camera.dark, camera.flat):
            if reference is not None:
                hashes[reference] = _hash_files(_match_files(recording.directory, reference))
    return hashes


def natural_key(path: Path) -> list[tuple[int, int, str]]:
    """Sort key that puts frame_2 before frame_10."""
    parts = re.split(r"(\d+)", str(path))
    return [(0, int(part), "") if part.isdigit() else (1, 0, part) for part in parts]


def read_encoder_log(path: Path) -> EncoderLog:
    """Read an encoder log, ``frame,time_s,angle_deg,load_N,temperature_C`` and further columns.

    Returns
    -------
    EncoderLog
        number (frame), angle (frame) [degree], and what else was logged.

    Raises
    ------
    EncoderError
        If the file is missing, a required column is, or a value is no finite number; frames repeated or missing.
        Each message names row and column, the header being row 1.
    """
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            table = [row for row in csv.reader(file) if any(cell.strip() for cell in row)]
    except OSError as error:
        raise EncoderError(f"Expected the encoder log {path.name}; it cannot be read: {error.strerror}.") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise EncoderError(f"Expected {path.name} to be a CSV text file; it is not: {error}.") from error
    if len(table) < 2:
        raise EncoderError(f"Expected a header and one row per trigger in {path.name}; it has {len(table)} lines.")
    header = [cell.strip() for cell in table[0]]
    for required in ("frame", "angle_deg"):
        if required not in header:
            raise EncoderError(f"Expected a column {required} in {path.name}; its header is {','.join(header)}.")
    repeated = [name for name, count in Counter(header).items() if count > 1]
    if repeated:
        raise EncoderError(f"Expected each column of {path.name} once; {repeated[0]} comes twice.")
    for number, row in enumerate(table[1:], 2):
        if len(row) != len(header):
            raise EncoderError(f"Expected {len(header)} values in row {number} of {path.name}; it has {len(row)}.")
    columns = dict(zip(header, zip(*table[1:], strict=True), strict=True))
    numbers = _number_column(columns.pop("frame"), "frame", path)
    _check_frame_numbers(numbers, path)
    log = xr.Dataset({"number": ("frame", numbers.astype(np.int64))})
    for name, cells in columns.items():
        if name in _KNOWN_COLUMNS:
            short, unit, meaning = _KNOWN_COLUMNS[name]
            log[short] = ("frame", _number_column(cells, name, path), {"units": unit, "long_name": meaning})
        else:
            log[name] = ("frame", _free_column(cells))
    return EncoderLog(log)


def _number_column(cells: Sequence[str], name: str, path: Path) -> npt.NDArray[np.float64]:
    values = np.empty(len(cells))
    for n, cell in enumerate(cells):
        try:
            values[n] = float(cell)
        except ValueError:
            values[n] = math.nan
        if not math.isfinite(values[n]):
            shown = cell.strip() or "nothing"
            raise EncoderError(
                f"Expected a finite number in row {n + 2}, column {name} of {path.name}; got {shown!r}. Correct the row, or "
                "delete it together with its frame of both cameras."
            )
    return values


def _check_frame_numbers(numbers: npt.NDArray[np.float64], path: Path) -> None:
    seen: dict[float, int] = {}
    for n, number in enumerate(numbers):
        row = n + 2
        if number in seen:
            raise EncoderError(
                f"Row {row}, column frame of {path.name} repeats frame {number:g} of row {seen[number]}; expected each once."
            )
        seen[number] = row
        expected = numbers[0] + n
        if number != expected:
            raise EncoderError(
                f"Row {row}, column frame of {path.name}: expected frame {expected:g}, got {number:g}; a frame is missing. Rows "
                "must be numbered without gaps, one per frame file."
            )


def _free_column(cells: Sequence[str]) -> npt.NDArray[Any]:
    try:
        return np.array([float(cell) for cell in cells])
    except ValueError:
        return np.array([cell.strip() for cell in cells], dtype=object).astype(str)


def _pair_cameras(
    directory: Path, settings: RunSettings | FixtureSettings, *, skip_bad_frames: bool
) -> tuple[tuple[tuple[Page, ...], tuple[Page, ...]], tuple[int, int], dict[int, str]]:
    cameras = (settings.camera1, settings.camera2)
    if settings.camera1.band >= settings.camera2.band:
        raise FrameError(
            f"Expected the band that dye 2 reabsorbs, the shorter wavelength, on camera 1; got {settings.camera1.band:g} nm on "
            f"camera 1 and {settings.camera2.band:g} nm on camera 2. The cameras look swapped: exchange the two tables."
        )
    found = [_find_pages(directory, camera.files, f"camera{n}") for n, camera in enumerate(cameras, 1)]
    one, two = ([page for page, _ in pages] for pages, _ in found)
    if len(one) != len(two):
        longer, name = (one, "camera1") if len(one) > len(two) else (two, "camera2")
        unmatched = _first_unmatched(one, two)
        raise FrameError(
            f"Expected as many frames of camera 2 as of camera 1; camera1 has {len(one)}, camera2 has {len(two)}. The first "
            f"unmatched one is {name}/{unmatched or longer[min(len(one), len(two))].name}. To drop it, move it out of the folder"
            + (" and delete its row of the encoder log." if isinstance(settings, RunSettings) else ".")
        )
    faults = {
        k: f"camera{camera}/{pages[k][0].name}: {reason}"
        for camera, (pages, bad) in enumerate(found, 1)
        for k, reason in bad.items()
    }
    if skip_bad_frames:
        faults |= _undecodable(directory, (one, two), faults)
    if faults and not skip_bad_frames:
        raise FrameError(_fault_message(faults, "frame"))
    kinds = [[kind for _, kind in pages] for pages, _ in found]
    good = [k for k in range(len(one)) if k not in faults]
    if not good:
        raise FrameError(
            f"Expected readable frames in {directory}; every pair has an unreadable file: {next(iter(faults.values()))}."
        )
    usual = Counter(kind[k] for kind in kinds for k in good).most_common(1)[0][0]
    for camera, kind in enumerate(kinds, 1):
        for k in good:
            if kind[k] != usual:
                page = (one, two)[camera - 1][k]
                raise FrameError(
                    f"Expected frames of one size and type, {_size(usual[0])} {usual[1]}; camera{camera}/{page.name} is "
                    f"{_size(kind[k][0])} {kind[k][1]}. Set the same region of interest and depth for all frames of both cameras."
                )
    (rows, columns), dtype = usual if len(usual[0]) == 2 else ((0, 0), f"{len(usual[0])}-dimensional {usual[1]}")
    if dtype not in ("uint8", "uint16"):
        raise FrameError(f"Expected grey frames of 8 or 16-bit unsigned counts; {one[good[0]].name} holds {dtype}.")
    if min(rows, columns) < 64:
        raise FrameError(
            f"Expected frames of at least 64 x 64 pixels; {one[good[0]].name} is {_size((rows, columns))}."
        )
    for camera_settings, pages in zip(cameras, (one, two), strict=True):
        _check_full_scale(_read_page(pages[good[0]], directory), camera_settings, pages[good[0]])
    return (tuple(one), tuple(two)), (rows, columns), faults


def _undecodable(directory: Path, cameras: tuple[list[Page], list[Page]], known: dict[int, str]) -> dict[int, str]:
    """Frame pairs whose headers are sound and whose pixels are not."""
    faults = {}
    for camera, pages in enumerate(cameras, 1):
        for k, page in enumerate(pages):
            if k not in known and k not in faults:
                try:
                    _read_page(page, directory)
                except FrameError:
                    faults[k] = f"camera{camera}/{page.name}: it cannot be decoded"
    return faults


def _first_unmatched(one: list[Page], two: list[Page]) -> str | None:
    """Name of the first file that the other camera has no namesake of, where the names allow to tell."""
    names_one, names_two = {page.name for page in one}, {page.name for page in two}
    if not names_one & names_two:
        return None
    only = [page.name for page in (one if len(one) > len(two) else two) if page.name not in names_one & names_two]
    return only[0] if only else None


_Kind = tuple[tuple[int, ...], str]


def _match_files(directory: Path, pattern: str) -> list[Path]:
    return sorted((path for path in directory.glob(pattern) if path.is_file()), key=natural_key)


def _find_pages(directory: Path, pattern: str, what: str) -> tuple[list[tuple[Page, _Kind]], dict[int, str]]:
    """Pages that match a pattern, with size and type; and the faulty ones by their place."""
    paths = _match_files(directory, pattern)
    if not paths:
        raise FrameError(f"Expected files {pattern} of {what} in {directory}; there is none.")
    pages: list[tuple[Page, _Kind]] = []
    faults: dict[int, str] = {}
    for path in paths:
        try:
            pages += [(Page(path, n), kind) for n, kind in enumerate(_headers(path))]
        except FrameError as error:
            faults[len(pages)] = str(error)
            pages.append((Page(path, 0), ((0, 0), "unreadable")))
    return pages, faults


def _headers(path: Path) -> list[_Kind]:
    """Size and type of each image in a file; FrameError with the bare reason."""
    size = path.stat().st_size
    if size == 0:
        raise FrameError("the file is empty")
    if path.suffix.lower() not in _TIFF:
        images = _read_foreign(path)
        return [(image.shape, image.dtype.name) for image in images]
    try:
        with tifffile.TiffFile(path) as file:
            kinds = []
            for page in file.pages:
                if not isinstance(page, tifffile.TiffPage):
                    page = page.aspage()
                ends = [a + b for a, b in zip(page.dataoffsets, page.databytecounts, strict=False)]
                if not ends or max(ends) > size:
                    raise FrameError("the file is truncated")
                kinds.append((tuple(page.shape), str(page.dtype)))
    except FrameError:
        raise
    except Exception as error:  # tifffile raises whatever the damaged bytes lead it to
        raise FrameError(f"the file is damaged or not a TIFF ({error})") from error
    if not kinds:
        raise FrameError("the file holds no image")
    return kinds


def _read_page(page: Page, directory: Path) -> Counts:
    try:
        if page.path.suffix.lower() in _TIFF:
            image = tifffile.imread(page.path, key=page.index)
        else:
            image = _read_foreign(page.path)[page.index]
    except FrameError as error:
        raise FrameError(f"{page.path.relative_to(directory)}: {error}.") from error
    except Exception as error:  # a decoder raises whatever the damaged bytes lead it to
        raise FrameError(
            f"Expected an image in {page.name}; it cannot be decoded ({error}). Record it again, or use --skip-bad-frames to leave "
            "out this frame pair."
        ) from error
    return np.asarray(image)


def _read_foreign(path: Path) -> list[npt.NDArray[Any]]:
    """Images of a file that is no TIFF, by whichever reader is installed."""
    import imageio.v3 as iio

    try:
        stack = np.stack(list(iio.imiter(path)))
    except Exception as error:
        raise FrameError(f"no installed reader knows this file ({error}); try: pip install 'erlif[formats]'") from error
    return [stack] if stack.ndim == 2 else list(stack)


def _check_full_scale(counts: Counts, settings: CameraSettings, page: Page) -> None:
    top = int(counts.max())
    if top <= settings.full_scale:
        return
    depth = max(8, top.bit_length())
    fits = f"bit_depth = {depth} fits"
    if depth == 16 and not np.any(counts & 15):
        fits = "all are multiples of 16, so these are 12-bit counts left-aligned in 16: shift them right by 4, or set bit_depth = 16"
    raise FrameError(
        f"Expected counts up to {settings.full_scale} (bit_depth = {settings.bit_depth}); {page.name} reaches {top}: {fits}."
    )


def depth_warning(settings: CameraSettings, highest: int, *, camera: int) -> str | None:
    """Say so where no count of a run comes near full scale: too little light, or another bit depth."""
    if highest > settings.full_scale // 16:
        return None
    return (
        f"camera{camera}: no count is above {highest} of {settings.full_scale} (bit_depth = {settings.bit_depth}); "
        f"bit_depth = {max(8, highest.bit_length())} would fit, or the light is very low."
    )


def _fault_message(faults: dict[int, str], what: str) -> str:
    first = faults[min(faults)]
    more = f" ({len(faults) - 1} more are unreadable)" if len(faults) > 1 else ""
    return (
        f"Expected readable files; {first}{more}. Record it again, or use --skip-bad-frames to leave out this frame pair."
        if what == "frame"
        else f"Expected readable {what} pages; {first}{more}."
    )


def _hash_files(paths: Iterable[Path]) -> str:
    total = hashlib.sha256()
    for path in paths:
        with path.open("rb") as file:
            total.update(hashlib.file_digest(file, "sha256").digest())
    return total.hexdigest()


def _size(shape: tuple[int, ...]) -> str:
    """Width x height, as cameras are described."""
    return " x ".join(str(n) for n in reversed(shape))
