"""The files of a directory that has no settings yet: frames, darks, flats and tables."""

from __future__ import annotations

import os
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

from erlif.core.bounded import read_rows
from erlif.core.errors import FrameError
from erlif.io.ingest import naming
from erlif.io.ingest.depth import CountsSample, sample_counts
from erlif.io.ingest.images import Page, read_headers
from erlif.io.ingest.logs.proposal import LOG_SUFFIXES, PROFILE
from erlif.io.ingest.order import sort_files, split_name
from erlif.io.ingest.selection import WHOLE, Selection
from erlif.io.ingest.shared import SharedFile, find_cameras_in_file
from erlif.io.readers import Format
from erlif.io.readers.hdf5 import HDF5, list_datasets
from erlif.io.readers.registry import find_by_content, find_by_suffix, why_unread

# Names that erlif itself writes; what they hold are not frames.
OWN_OUTPUT = frozenset({"figures", "calibration.png", "film.zarr", "truth.nc"})

# Levels of folders below the directory that are searched.
DEEPEST = 3

# Files beyond which a directory is refused: it is not that of one run.
MOST_FILES = 200_000

# Suffixes of which one file is opened where none is that of a format.
MOST_SUFFIXES = 50

# Size of a CSV file above which it is neither a log nor a profile. [byte]
LARGEST_TABLE = 64 * 2**20

# Pages of a camera whose counts are read for the bit depth.
SAMPLED_PAGES = 12


@dataclass(frozen=True)
class ImageSet:
    """Files of one camera that serve one purpose.

    Attributes
    ----------
    files : tuple[Path, ...]
        In natural order.
    pattern : str | None
        Pattern that matches these files and no others; None where there is none.
    pages : int
        Number of images in the files.
    kinds : tuple[str, ...]
        Different sizes and types, the most frequent first: "320 x 256 uint16".
    faults : tuple[str, ...]
        Names of files that cannot be read, with the reason.
    bits : int | None
        Significant bits of a count after the headers; None where they state none, or differ.
    sample : tuple[tuple[Page, tuple[int, ...]], ...]
        A few readable pages, evenly over all, with their shapes. [px]
    """

    files: tuple[Path, ...]
    pattern: str | None
    pages: int
    kinds: tuple[str, ...]
    faults: tuple[str, ...]
    bits: int | None
    sample: tuple[tuple[Page, tuple[int, ...]], ...]

    @property
    def of_fixture(self) -> bool:
        """Whether the name of a recording is that of a fixture."""
        return bool(naming.FIXTURE.search(naming.lower_name(self.files[0], self.files[0].parent)))


@dataclass(frozen=True)
class CameraSurvey:
    """Files of one camera, as recognised by their names.

    Attributes
    ----------
    label : str
        Part of the names by which the files of this camera are recognised.
    wavelength : int | None
        Wavelength in the names of its files; None where there is none. [nm]
    frames : ImageSet
        Images of no other purpose.
    darks : ImageSet | None
        None where no name has one of the words for darks.
    flats : ImageSet | None
        None where no name has one of the words for flats.
    backgrounds : ImageSet | None
        Images of the dry joint; None where no name has one of the words for them.
    counts : CountsSample | None
        None where no page can be read.
    shared : SharedFile | None
        How the two are separated, and what shows it; None where each has its own files.
    recordings : tuple[ImageSet, ...]
        Where each file is a recording: all of them, of which frames is one; else empty.
    chosen : bool
        Whether the names of the recordings show which of them is meant.
    """

    label: str
    wavelength: int | None
    frames: ImageSet
    darks: ImageSet | None
    flats: ImageSet | None
    backgrounds: ImageSet | None
    counts: CountsSample | None
    shared: SharedFile | None = None
    recordings: tuple[ImageSet, ...] = ()
    chosen: bool = True


@dataclass(frozen=True)
class TextTable:
    """A CSV file.

    Attributes
    ----------
    path : Path
        The file.
    header : tuple[str, ...]
        Names of the columns.
    rows : int
        Rows below the header.
    """

    path: Path
    header: tuple[str, ...]
    rows: int


@dataclass(frozen=True)
class Survey:
    """Contents of a directory: cameras, unassigned images, tables and logs.

    Attributes
    ----------
    directory : Path
        Directory that was searched.
    cameras : tuple[CameraSurvey, ...]
        In the order of their wavelengths, else of their names.
    unassigned : tuple[Path, ...]
        Images that belong to no camera by their names.
    tables : tuple[TextTable, ...]
        CSV files, in the order of their names.
    logs : tuple[Path, ...]
        Files that a data logger may have written, tables among them.
    in_order : tuple[str, ...]
        "darks" or "flats" that no name assigns to a camera and that are taken in the order of
        their names.
    unread : tuple[Path, ...]
        Files of formats that are known and not read.
    left_out : tuple[Path, ...]
        Folders of fixtures, whose images are none of this run.
    masks : tuple[Path, ...]
        Images named as masks.
    """

    directory: Path
    cameras: tuple[CameraSurvey, ...]
    unassigned: tuple[Path, ...]
    tables: tuple[TextTable, ...]
    logs: tuple[Path, ...] = ()
    in_order: tuple[str, ...] = ()
    unread: tuple[Path, ...] = ()
    left_out: tuple[Path, ...] = ()
    masks: tuple[Path, ...] = ()

    @property
    def lone_darks(self) -> tuple[Path, ...]:
        """Images named as darks that belong to no camera by their names."""
        names = {path: naming.lower_name(path, self.directory) for path in self.unassigned}
        return tuple(path for path, name in names.items() if naming.purpose_of(name) == "darks")


def survey_directory(directory: Path, *, fixture: bool = False) -> Survey:
    """Find the frames, darks, flats and CSV tables in a directory.

    Parameters
    ----------
    directory : Path
        Folder of a run or of a fixture; the folders in it are searched too.
    fixture : bool
        Whether recordings of a fixture are meant, where their names show them, or all others:
        folders of fixtures then have no camera of the run.

    Returns
    -------
    Survey
        With as many cameras as the names distinguish: none, one, two or more.

    Raises
    ------
    FrameError
        If there is no such directory, or if it holds too many files for one run.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as empty:
    ...     survey_directory(Path(empty)).cameras
    ()
    """
    if not directory.is_dir():
        raise FrameError(
            f"Expected a directory with frames; {directory} is not a directory. Name the folder "
            "that holds the frames of both cameras."
        )
    files = sorted(islice(_walk(directory, DEEPEST), MOST_FILES + 1))
    if len(files) > MOST_FILES:
        raise FrameError(
            f"Expected the directory of one run; {directory} holds more than {MOST_FILES} files. "
            "Name the folder of one run."
        )

    read = (_read_table(path) for path in files if path.suffix.lower() == ".csv")
    tables = tuple(table for table in read if table is not None)
    images = sort_files(_find_images(files))
    names = {path: naming.lower_name(path, directory) for path in images}
    left_out: tuple[Path, ...] = ()
    if not fixture:
        names, left_out = _leave_out_fixtures(names, directory, tables)
    masks = tuple(path for path in names if naming.MASK.search(naming.split_words(path.stem)))
    names = {path: name for path, name in names.items() if path not in masks}
    groups, unassigned = naming.group_by_camera(names)
    in_order = naming.assign_in_order(groups, unassigned, names)
    cameras = [
        _choose_recording(_describe_camera(label, group, directory), directory, fixture=fixture)
        for label, group in groups.items()
    ]
    # a number that all cameras share is none of a filter ("run_500")
    wavelengths = {camera.wavelength for camera in cameras}
    if len(wavelengths) < len(cameras) or None in wavelengths:
        cameras = [replace(camera, wavelength=None) for camera in cameras]
    cameras.sort(key=lambda camera: (camera.wavelength or 0, split_name(camera.label)))
    if len(groups) == 1:
        ((label, group),) = groups.items()
        shared = find_cameras_in_file(group["frames"][0], [table.rows for table in tables])
        if shared is not None:
            cameras, unassigned = _separate(shared, label, group, unassigned, directory)

    return Survey(
        directory,
        tuple(cameras),
        tuple(unassigned),
        tables,
        logs=tuple(path for path in files if path.suffix.lower() in LOG_SUFFIXES),
        in_order=in_order,
        unread=tuple(path for path in files if why_unread(path.suffix)),
        left_out=left_out,
        masks=masks,
    )


# files


def _walk(directory: Path, depth: int) -> Iterator[Path]:
    """Ordinary files, hidden ones and those behind links out of the directory left out."""
    for entry in sorted(os.scandir(directory), key=lambda entry: entry.name):
        if entry.name.startswith(".") or entry.name in OWN_OUTPUT or entry.is_symlink():
            continue
        if entry.is_dir() and depth:
            yield from _walk(Path(entry.path), depth - 1)
        elif entry.is_file():
            yield Path(entry.path)


def _find_images(files: Sequence[Path]) -> list[Path]:
    """Files of the formats that are read, each recording once."""
    forms = {suffix: find_by_suffix(suffix) for suffix in {path.suffix for path in files}}
    images = {path: form for path in files if (form := forms[path.suffix]) is not None}
    found = [path for path, form in images.items() if _holds_frames(path, form)]

    # the header beside the counts, or the folder of a recording, is no second one
    beside = {
        path.with_suffix(written)
        for path in found
        if path.suffix.lower() not in images[path].beside
        for ending in images[path].beside
        for written in (ending, ending.upper())
    }
    if beside:
        found = [path for path in found if beside.isdisjoint((path, *path.parents))]
    if found:
        return found

    # some formats have no suffix of their own: one file of each is opened
    kinds = {path: re.sub(r"\d+", "#", path.suffix) for path in files if path not in images}
    first = islice({kind: path for path, kind in kinds.items()}.items(), MOST_SUFFIXES)
    known = {kind for kind, path in first if find_by_content(path) is not None}
    return [path for path, kind in kinds.items() if kind in known]


def _holds_frames(path: Path, form: Format) -> bool:
    """Whether a file of a suffix that loggers use as well holds frames."""
    if form is HDF5:
        return bool(list_datasets(path))
    return path.suffix.lower() not in LOG_SUFFIXES or find_by_content(path) is form


def _read_table(path: Path) -> TextTable | None:
    """Header and length of a CSV file; None where it is none."""
    try:
        rows = read_rows(path, largest=LARGEST_TABLE)
    except (OSError, ValueError):
        return None
    return TextTable(path, tuple(rows[0][1]), len(rows) - 1) if rows else None


def _leave_out_fixtures(
    names: dict[Path, str], directory: Path, tables: Sequence[TextTable]
) -> tuple[dict[Path, str], tuple[Path, ...]]:
    """Return the images outside folders of fixtures, and these folders; all if no frame is left."""
    profiles = {table.path.parent for table in tables if set(table.header) >= PROFILE}
    inside: dict[Path, Path] = {}
    for path in names:
        for folder in path.parents[: len(path.relative_to(directory).parts) - 1]:
            settings = (folder / "fixture.toml").is_file()
            if settings or folder in profiles or naming.FIXTURE.search(folder.name.lower()):
                inside[path] = folder
    rest = {path: name for path, name in names.items() if path not in inside}
    if not any(naming.purpose_of(name) == "frames" for name in rest.values()):
        return names, ()
    return rest, tuple(dict.fromkeys(inside.values()))


# cameras


def _separate(
    shared: SharedFile, label: str, group: naming.Group, unassigned: Sequence[Path], directory: Path
) -> tuple[list[CameraSurvey], list[Path]]:
    """Both cameras of files that hold two, and the files of neither."""
    # no name has to name a camera where one file of darks holds both
    rest: list[Path] = []
    for path in unassigned:
        purpose = naming.purpose_of(naming.lower_name(path, directory))
        (rest if purpose == "frames" else group[purpose]).append(path)

    cameras = []
    for number, value in enumerate(shared.values):
        name = f"{label} {value}" if shared.key == "part" else value
        selection = Selection(part=value) if shared.key == "part" else Selection(dataset=value)
        camera = _describe_camera(name, group, directory, selection)
        if shared.key == "dataset":
            # darks and flats may lie in the file of the frames
            darks, flats = (
                names
                and _describe_set(group["frames"], directory, Selection(dataset=names[number]))
                for names in (shared.darks, shared.flats)
            )
            camera = replace(camera, darks=darks, flats=flats)
        cameras.append(replace(camera, shared=shared))
    return cameras, rest


def _describe_camera(
    label: str, group: naming.Group, directory: Path, selection: Selection = WHOLE
) -> CameraSurvey:
    """Read the headers of a camera's files, and the counts of some."""
    sets = {
        purpose: _describe_set(files, directory, selection)
        for purpose, files in group.items()
        if files
    }
    frames = sets["frames"]
    darks, flats, backgrounds = (sets.get(purpose) for purpose in naming.PURPOSES)

    # flats are brighter than many a film: they show bits that the frames do not set
    sample = frames.sample + (flats.sample if flats else ())
    return CameraSurvey(
        label,
        naming.common_wavelength([naming.lower_name(path, directory) for path in group["frames"]]),
        frames,
        darks,
        flats,
        backgrounds,
        counts=sample_counts(sample, directory, frames.bits),
    )


def _choose_recording(camera: CameraSurvey, directory: Path, *, fixture: bool) -> CameraSurvey:
    """One of several recordings of a camera, by the words in their names, else the longest."""
    parts: dict[str, list[Path]] = defaultdict(list)
    for path in camera.frames.files:
        form = find_by_suffix(path.suffix)
        movie = form is not None and form.movie
        parts[path.stem if movie else re.sub(r"\d+", "#", path.stem)].append(path)
    if len(parts) < 2:
        return camera

    # a file of a single image is no recording
    described = [_describe_set(part, directory) for part in parts.values()]
    if any(one.pages < 2 * len(one.files) for one in described):
        return camera
    wanted = [one for one in described if one.of_fixture == fixture] or described
    frames = max(wanted, key=lambda one: one.pages)
    return replace(
        camera,
        frames=frames,
        counts=sample_counts(frames.sample, directory, frames.bits) or camera.counts,
        recordings=tuple(described),
        chosen=len(wanted) == 1,
    )


def _describe_set(files: Sequence[Path], directory: Path, selection: Selection = WHOLE) -> ImageSet:
    """Number, kinds and faults of the images in files by their headers."""
    headers = read_headers(files, selection)
    faults = tuple(
        f"{os.path.relpath(headers.pages[k].path, directory)}: {reason}"
        for k, reason in headers.faults.items()
    )
    readable = [
        (page, kind)
        for k, (page, kind) in enumerate(zip(headers.pages, headers.kinds, strict=True))
        if k not in headers.faults
    ]
    kinds = Counter(str(kind) for _, kind in readable)
    step = max(len(readable) // SAMPLED_PAGES, 1)
    return ImageSet(
        tuple(files),
        naming.find_pattern(files, directory),
        len(headers.pages),
        tuple(kind for kind, _ in kinds.most_common()),
        faults,
        headers.bits,
        tuple((page, kind.shape) for page, kind in readable[::step]),
    )
