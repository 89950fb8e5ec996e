"""A run or fixture directory, as the rig wrote it, to counts of both cameras and an encoder log.

Opening a directory reads every header and the whole log, so that what does not fit together is refused before anything is
computed; the frames themselves are read pair by pair when a stage asks for them.
"""

from __future__ import annotations

import csv
import glob
import hashlib
import math
import os
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

from erlif.config import (
    CameraSettings,
    FixtureSettings,
    RunSettings,
    read_fixture_settings,
    read_run_settings,
)
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
_FURTHER_COLUMN = re.compile(r"[^\W_][^/\x00-\x1f\x7f]*")  # what every file format takes as a name
# fmt: off
_RESERVED = frozenset({
    "number", "angle", "time", "load", "temperature", "trigger", "x", "y", "thickness", "thickness_std",
    "thickness_std_shared", "flags", "frames_used", "encoder_angle", "stroke", "crank_angle", "rocker_speed",
    "sliding_speed", "film_mean", "film_mean_std", "film_min", "film_min_std", "film_hamrock_dowson",
    "film_theory", "film_parameter", "speed_exponent", "speed_exponent_std", "speed_exponent_mean",
    "speed_exponent_mean_std",
})
# fmt: on
"""Names of the film's own variables, which no further column of the log may have."""

_DENSEST = 1100  # pixels per byte of a file: deflate packs no tighter


@dataclass(frozen=True)
class Page:
    """One image in a file."""

    path: Path
    index: int

    @property
    def name(self) -> str:
        """File name, with the page from the second on; bytes that are no UTF-8 are replaced, for the files that name it."""
        name = os.fsencode(self.path.name).decode(errors="replace")
        return name if self.index == 0 else f"{name}[{self.index}]"


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
    _check_rows(log, pages[0], settings.encoder.file)
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
    for camera, (pages, settings) in enumerate(
        zip(recording.pages, recording.cameras, strict=True)
    ):
        for n, k in enumerate(frames):
            counts[camera, n] = _read_page(pages[k], recording.directory, recording.shape)
            _check_depth(counts[camera, n], settings, pages[k])
    return Frames(
        xr.Dataset(
            {
                "counts": (
                    ("camera", "frame", "y", "x"),
                    counts,
                    {"units": "DN", "long_name": "raw counts"},
                )
            },
            {"camera": [1, 2], "frame": np.asarray(frames, np.int64)},
        )
    )


def find_reference_pages(directory: Path, pattern: str, *, what: str) -> list[Page]:
    """Find the pages of a dark or flat recording and check their headers; raises FrameError."""
    pages, faults = _find_pages(directory, pattern, what)
    if faults:
        raise FrameError(
            f"Expected readable {what} pages; {pages[min(faults)][0].name}: {faults[min(faults)]}. Record them again, or take the file out."
        )
    return [page for page, _ in pages]


def read_reference(
    page: Page, settings: CameraSettings, *, directory: Path, shape: tuple[int, int]
) -> Counts:
    """Read one dark or flat page and check its size and counts; raises FrameError."""
    counts = _read_page(page, directory, shape)
    _check_depth(counts, settings, page)
    return counts


def hash_inputs(recording: Recording) -> dict[str, str]:
    """SHA-256 of every input by its name in the directory; the files of one pattern share one hash."""
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
    return {
        os.path.relpath(recording.directory / name, recording.directory): value
        for name, value in hashes.items()
    }


def natural_key(path: Path) -> list[tuple[int, int, str]]:
    """Sort key that puts frame_2 before frame_10."""
    parts = re.split(r"(\d+)", str(path))
    return [(0, int(part), "") if n % 2 else (1, 0, part) for n, part in enumerate(parts)]


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
            table = [
                (n, row)
                for n, row in enumerate(csv.reader(file), 1)
                if any(cell.strip() for cell in row)
            ]
    except OSError as error:
        raise EncoderError(
            f"Expected the encoder log {path.name}; it cannot be read: {error.strerror}. Correct file in [encoder] of run.toml."
        ) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise EncoderError(
            f"Expected {path.name} to be a CSV text file; it is not: {error}. Save the log as CSV in UTF-8."
        ) from error
    if len(table) < 2:
        raise EncoderError(
            f"Expected a header and one row per trigger in {path.name}; it has {len(table)} row(s). Export the whole log."
        )
    header = [cell.strip() for cell in table[0][1]]
    rows = [number for number, _ in table[1:]]
    _check_header(header, path)
    for number, row in table[1:]:
        if len(row) != len(header):
            comma = (
                " A decimal comma makes two values of one: write decimal points."
                if len(row) > len(header)
                else ""
            )
            raise EncoderError(
                f"Expected {len(header)} values in row {number} of {path.name}, as in its header; it has {len(row)}.{comma} Correct the row."
            )
    columns = dict(zip(header, zip(*(row for _, row in table[1:]), strict=True), strict=True))
    numbers = _number_column(columns.pop("frame"), rows, "frame", path)
    _check_frame_numbers(numbers, rows, path)
    log = xr.Dataset({"number": ("frame", numbers.astype(np.int64))})
    for name, cells in columns.items():
        if name in _KNOWN_COLUMNS:
            short, unit, meaning = _KNOWN_COLUMNS[name]
            log[short] = (
                "frame",
                _number_column(cells, rows, name, path),
                {"units": unit, "long_name": meaning},
            )
        elif name:
            log[name] = ("frame", _free_column(cells))
    if "load" in log and log["load"].values.min() <= 0:
        n = int(np.argmin(log["load"].values))
        raise EncoderError(
            f"Expected a positive load in row {rows[n]}, column load_N of {path.name}; got {log['load'].values[n]:g} N. Correct the zero of the "
            "load cell, or leave the column out and give the load in [joint] of run.toml."
        )
    return EncoderLog(log)


def _check_header(header: list[str], path: Path) -> None:
    for required in ("frame", "angle_deg"):
        if required not in header:
            comma = "" if len(header) > 1 else " Separate the columns with commas."
            raise EncoderError(
                f"Expected a column {required} in {path.name}; its header is {','.join(header)}.{comma} Columns erlif knows: frame, "
                f"{', '.join(_KNOWN_COLUMNS)}."
            )
    for place, (name, count) in enumerate(Counter(header).items(), 1):
        if count > 1 and name:
            raise EncoderError(
                f"Expected each column of {path.name} once; {name} comes {count} times. Rename one."
            )
        if name in _RESERVED or (name and not _FURTHER_COLUMN.fullmatch(name)):
            reason = (
                "which erlif uses itself" if name in _RESERVED else "which a film file cannot hold"
            )
            raise EncoderError(
                f"Expected a column of {path.name} to be one of frame, {', '.join(_KNOWN_COLUMNS)} or to have a name of its own that begins "
                f"with a letter or digit; column {place} is {name!r}, {reason}. Rename it."
            )


def _number_column(
    cells: Sequence[str], rows: Sequence[int], name: str, path: Path
) -> npt.NDArray[np.float64]:
    values = np.empty(len(cells))
    for n, (row, cell) in enumerate(zip(rows, cells, strict=True)):
        try:
            values[n] = float(cell) if "_" not in cell else math.nan
        except ValueError:
            values[n] = math.nan
        if not math.isfinite(values[n]):
            raise EncoderError(
                f"Expected a finite number in row {row}, column {name} of {path.name}; got {cell.strip() or 'nothing'!r}. Correct the value, "
                "or take the row and its frame of both cameras out and number the rows anew."
            )
    return values


def _check_frame_numbers(numbers: npt.NDArray[np.float64], rows: Sequence[int], path: Path) -> None:
    seen: dict[float, int] = {}
    for n, (row, number) in enumerate(zip(rows, numbers, strict=True)):
        if number != round(number) or abs(number) > 2**53:
            raise EncoderError(
                f"Expected a whole number in row {row}, column frame of {path.name}; got {number:g}. Number the rows 0, 1, 2, ..."
            )
        if number in seen:
            raise EncoderError(
                f"Expected each frame once in {path.name}; row {row}, column frame, repeats frame {number:g} of row {seen[number]}. Delete "
                "one of the two rows."
            )
        seen[number] = row
        expected = numbers[0] + n
        if number != expected:
            raise EncoderError(
                f"Expected frame {expected:g} in row {row}, column frame of {path.name}; got {number:g}: a frame is missing. Put its row back, "
                "or, if its frame files are missing too, number the rows anew."
            )


def _free_column(cells: Sequence[str]) -> npt.NDArray[Any]:
    """Numbers where all cells that are not empty are numbers, text otherwise."""
    try:
        return np.array([float(cell) if cell.strip() else math.nan for cell in cells])
    except ValueError:
        return np.array([cell.strip() for cell in cells], dtype=object).astype(str)


def _check_rows(log: EncoderLog, pages: Sequence[Page], name: str) -> None:
    """Refuse a log that has not one row per frame, naming the first row or frame without its like."""
    rows, frames = log.sizes["frame"], len(pages)
    if rows == frames:
        return
    if rows > frames:
        # where the files carry the numbers of the log, the gap in them is the missing one
        numbers = _numbers(pages)
        logged = log.number.values.tolist()
        lacking = (
            [number for number in logged if number not in numbers]
            if set(numbers) <= set(logged)
            else []
        )
        row = logged.index(lacking[0]) if lacking else frames
        extra = f"frame {logged[row]} of {name} is the first without a file"
    else:
        extra = f"{pages[rows].name} is the first without a row"
    raise EncoderError(
        f"Expected one row of {name} per frame; {name} has {rows} rows, the cameras have {frames} frames each: {extra}. To leave a frame "
        "out, put an empty file of its name into both camera folders and use --skip-bad-frames; or take out row and files and number the "
        "rows anew."
    )


def _pair_cameras(
    directory: Path, settings: RunSettings | FixtureSettings, *, skip_bad_frames: bool
) -> tuple[tuple[tuple[Page, ...], tuple[Page, ...]], tuple[int, int], dict[int, str]]:
    cameras = (settings.camera1, settings.camera2)
    if settings.camera1.band >= settings.camera2.band:
        raise FrameError(
            f"Expected the band that dye 2 reabsorbs, the shorter wavelength, on camera 1; got {settings.camera1.band:g} nm on "
            f"camera 1 and {settings.camera2.band:g} nm on camera 2. The cameras look swapped: exchange the two tables."
        )
    found = [
        _find_pages(directory, camera.files, f"camera{n}") for n, camera in enumerate(cameras, 1)
    ]
    if skip_bad_frames:
        _pad_truncated(found)
    one, two = ([page for page, _ in pages] for pages, _ in found)
    faults = {
        k: f"camera{camera}/{pages[k][0].name}: {reason}"
        for camera, (pages, bad) in enumerate(found, 1)
        for k, reason in bad.items()
    }
    if faults and not skip_bad_frames:
        raise FrameError(_fault_message(faults))
    _check_pairs(one, two)
    if skip_bad_frames:
        faults |= _undecodable(directory, found, faults)
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
    shape, dtype = usual
    if len(shape) != 2 or dtype not in ("uint8", "uint16"):
        colour = f" in {shape[2]} colours" if len(shape) == 3 else ""
        raise FrameError(
            f"Expected grey frames of 8 or 16-bit unsigned counts; {one[good[0]].name} holds {dtype}{colour}. Save the raw counts of the "
            "cameras, one channel each."
        )
    if min(shape) < 64:
        raise FrameError(
            f"Expected frames of at least 64 x 64 pixels; {one[good[0]].name} is {_size(shape)}. Record a larger region of interest."
        )
    rows, columns = shape
    for camera_settings, pages in zip(cameras, (one, two), strict=True):
        _check_depth(_read_page(pages[good[0]], directory, shape), camera_settings, pages[good[0]])
    return (tuple(one), tuple(two)), (rows, columns), faults


def _undecodable(
    directory: Path,
    cameras: Sequence[tuple[list[tuple[Page, _Kind]], dict[int, str]]],
    known: dict[int, str],
) -> dict[int, str]:
    """Frame pairs whose headers are sound and whose pixels are not."""
    faults = {}
    for camera, (pages, _) in enumerate(cameras, 1):
        for k, (page, (shape, _)) in enumerate(pages):
            if k not in known and k not in faults:
                try:
                    _read_page(page, directory, shape)
                except FrameError:
                    faults[k] = f"camera{camera}/{page.name}: it cannot be decoded"
    return faults


def _check_pairs(one: Sequence[Page], two: Sequence[Page]) -> None:
    """Refuse cameras whose frames do not belong together pair by pair, naming the first that has no partner."""
    if {page.path for page in one} & {page.path for page in two}:
        raise FrameError(
            f"Expected frames of two cameras; both [camera1] and [camera2] name {one[0].path.name}. Correct files in one of them."
        )
    unmatched = _first_unmatched(one, two)
    if unmatched:
        raise FrameError(
            f"Expected as many frames of camera 2 as of camera 1, pair by pair; camera1 has {len(one)}, camera2 has {len(two)}. The first "
            f"unmatched one is {unmatched}. To drop it, put an empty file of its name into the other camera's folder and use "
            "--skip-bad-frames, or take it out of this one."
        )


def _first_unmatched(one: Sequence[Page], two: Sequence[Page]) -> str | None:
    """Camera and name of the first frame without a partner, by the numbers in the names where these run alike."""
    a, b = _numbers(one), _numbers(two)
    if len(one) == len(two):
        alike = len(set(a) & set(b)) >= len(one) / 2
        if not alike or len({first - second for first, second in zip(a, b, strict=True)}) == 1:
            return None  # each camera counts in its own way, or from its own first number
    pages, own, other, name = (
        (one, a, b, "camera1") if len(one) >= len(two) else (two, b, a, "camera2")
    )
    if not set(own) & set(other):
        return f"{name}/{pages[len(other)].name}"
    return f"{name}/{next(page.name for page, number in zip(pages, own, strict=True) if number not in other)}"


def _numbers(pages: Sequence[Page]) -> list[int]:
    """Number of each frame by its file name; their order where the names do not tell one from another."""
    found = [re.findall(r"\d+", page.path.stem) for page in pages]
    numbers = [int(digits[-1]) if digits else 0 for digits in found]
    return numbers if len(set(numbers)) == len(pages) else list(range(len(pages)))


def _pad_truncated(found: Sequence[tuple[list[tuple[Page, _Kind]], dict[int, str]]]) -> None:
    """Count the pages that a truncated multi-page file has lost as unreadable ones."""
    most = max(len(pages) for pages, _ in found)
    for pages, bad in found:
        last = pages[-1][0]
        if len(pages) - 1 in bad and last.path == pages[0][0].path:
            for n in range(len(pages), most):
                bad[n] = bad[last.index]
                pages.append((Page(last.path, n), _UNREADABLE))


_Kind = tuple[tuple[int, ...], str]
_UNREADABLE: _Kind = ((0, 0), "unreadable")


def _match_files(directory: Path, pattern: str) -> list[Path]:
    """Files that a pattern of the settings matches, in natural order; hidden ones are not meant."""
    names = glob.glob(pattern, root_dir=directory, recursive=True)
    return sorted(
        (path for path in (directory / name for name in names) if not path.is_dir()),
        key=natural_key,
    )


def _find_pages(
    directory: Path, pattern: str, what: str
) -> tuple[list[tuple[Page, _Kind]], dict[int, str]]:
    """Pages that match a pattern, with size and type; and the faulty ones by their place."""
    paths = _match_files(directory, pattern)
    if not paths:
        raise FrameError(
            f"Expected files {pattern} of {what} in {directory}; there is none. Put them there, or correct the name in the settings."
        )
    pages: list[tuple[Page, _Kind]] = []
    faults: dict[int, str] = {}
    for path in paths:
        try:
            kinds = _headers(path)
        except FrameError as error:
            faults[len(pages)] = str(error)
            kinds = [_UNREADABLE]
        for n, kind in enumerate(kinds):
            if kind == _UNREADABLE:
                faults.setdefault(len(pages), "the file is truncated")
            pages.append((Page(path, n), kind))
    return pages, faults


def _headers(path: Path) -> list[_Kind]:
    """Size and type of each image in a file; FrameError with the bare reason."""
    try:
        size = path.stat().st_size
        if size == 0:
            raise FrameError("the file is empty")
        kinds = (
            _tiff_headers(path, size) if path.suffix.lower() in _TIFF else _foreign_headers(path)
        )
    except OSError as error:
        raise FrameError(f"the file cannot be read: {error.strerror or error}") from error
    if not kinds:
        raise FrameError("the file holds no image")
    for shape, _ in kinds:
        if math.prod(shape) > _DENSEST * size:
            raise FrameError(f"the file is damaged: {size} bytes cannot hold {_size(shape)} pixels")
    return kinds


def _tiff_headers(path: Path, size: int) -> list[_Kind]:
    kinds = []
    try:
        with tifffile.TiffFile(path) as file:
            for page in file.pages:
                page = page if isinstance(page, tifffile.TiffPage) else page.aspage()
                ends = [a + b for a, b in zip(page.dataoffsets, page.databytecounts, strict=False)]
                whole = ends and max(ends) <= size
                shape = tuple(int(n) for n in page.shape)
                kinds.append((shape, np.dtype(page.dtype).name) if whole else _UNREADABLE)
    except OSError:
        raise
    except Exception as error:  # tifffile raises whatever the damaged bytes lead it to
        raise FrameError(f"the file is damaged or not a TIFF ({error})") from error
    return kinds


def _foreign_headers(path: Path) -> list[_Kind]:
    return [(image.shape, image.dtype.name) for image in _read_foreign(path)]


def _read_page(page: Page, directory: Path, shape: tuple[int, ...]) -> Counts:
    name = os.path.relpath(page.path, directory) + (f"[{page.index}]" if page.index else "")
    try:
        if page.path.suffix.lower() in _TIFF:
            image = np.asarray(tifffile.imread(page.path, key=page.index))
        else:
            image = _read_foreign(page.path)[page.index]
    except Exception as error:  # a decoder raises whatever the damaged bytes lead it to
        todo = "Record it again, or use --skip-bad-frames to leave out this frame pair."
        if "imagecodecs" in str(error):
            todo = "Install the decoders with: pip install 'erlif[formats]'"
        raise FrameError(
            f"Expected an image in {name}; it cannot be decoded ({error}). {todo}"
        ) from error
    if image.shape != shape or image.dtype not in (np.uint8, np.uint16):
        raise FrameError(
            f"Expected grey counts of {_size(shape)} pixels, 8 or 16-bit unsigned, in {name}; it is {image.dtype} of {_size(image.shape)}. "
            "Record frames, darks and flats with the same region of interest."
        )
    return image


def _read_foreign(path: Path) -> list[npt.NDArray[Any]]:
    """Images of a file that is no TIFF, by whichever reader is installed."""
    import imageio.v3 as iio

    try:
        return [np.asarray(image) for image in iio.imiter(path)]
    except Exception as error:  # each reader in its own way
        reason = str(error).strip().split("\n")[0]
        raise FrameError(
            f"no installed reader knows this file ({reason}); try: pip install 'erlif[formats]'"
        ) from error


def _check_depth(counts: Counts, settings: CameraSettings, page: Page) -> None:
    """Refuse counts above full scale, and such that stand in the upper bits: their saturation would go unseen."""
    top = int(counts.max())
    steps = int(np.bitwise_or.reduce(counts, axis=None))
    unused = (steps & -steps).bit_length() - 1  # low bits that no count sets
    if unused >= 2 and np.unique(counts).size > 16:
        depth = (16 if top > settings.full_scale else settings.bit_depth) - unused
        raise FrameError(
            f"Expected counts of {settings.bit_depth} bits; {page.name} holds multiples of {1 << unused} up to {top}: {depth}-bit counts, "
            f"left-aligned. Divide the counts by {1 << unused}, save them again and set bit_depth = {depth}."
        )
    if top > settings.full_scale:
        raise FrameError(
            f"Expected counts up to {settings.full_scale} (bit_depth = {settings.bit_depth}); {page.name} reaches {top}: bit_depth = "
            f"{top.bit_length()} fits. Set the bit depth of the camera."
        )


def depth_warning(settings: CameraSettings, highest: int, *, camera: int) -> str | None:
    """Say so where no count of a run comes near full scale: too little light, or another bit depth."""
    if highest > settings.full_scale // 16:
        return None
    return (
        f"camera{camera}: no count is above {highest} of {settings.full_scale} (bit_depth = {settings.bit_depth}); "
        f"bit_depth = {max(8, highest.bit_length())} would fit, or the light is very low."
    )


def _fault_message(faults: dict[int, str]) -> str:
    more = f" ({len(faults) - 1} more are unreadable)" if len(faults) > 1 else ""
    return f"Expected readable frames; {faults[min(faults)]}{more}. Record it again, or use --skip-bad-frames to leave out this frame pair."


def _hash_files(paths: Iterable[Path]) -> str:
    total = hashlib.sha256()
    for path in paths:
        try:
            with path.open("rb") as file:
                total.update(hashlib.file_digest(file, "sha256").digest())
        except OSError:  # a frame that is left out; what must be readable was read before
            total.update(b"unreadable")
    return total.hexdigest()


def _size(shape: tuple[int, ...]) -> str:
    """Width x height, as cameras are described."""
    return " x ".join(str(n) for n in reversed(shape))
