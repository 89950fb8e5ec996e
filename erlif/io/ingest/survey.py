"""The files of a directory that has no settings yet: frames, darks and flats by camera, and tables.

Laboratories name their files in many ways. The camera of a file is taken from a camera number in
its name ("Camera_2", "C1_0001.tif"), else from a wavelength ("610/", "frame_580nm_3.tif"), else
from its folder ("left/"), else from the text before the frame number ("left_0001.tif").
"""

from __future__ import annotations

import glob
import os
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import Path

import numpy as np

from erlif.core.bounded import read_rows
from erlif.core.errors import FrameError
from erlif.io.ingest.counts import FEW_LEVELS, count_padding
from erlif.io.ingest.images import Page, match_files, natural_key, read_headers, read_page
from erlif.io.ingest.logs.proposal import LOG_SUFFIXES, PROFILE
from erlif.io.ingest.selection import WHOLE, Selection
from erlif.io.ingest.shared import SharedFile, find_cameras_in_file
from erlif.io.readers.hdf5 import list_datasets

# Formats in which cameras store grey counts, and which erlif has a reader for.
IMAGE_SUFFIXES = frozenset(
    {
        *(".tif", ".tiff", ".btf", ".png", ".bmp", ".pgm", ".npy", ".avi"),
        *(".fits", ".fit", ".fts", ".h5", ".hdf5"),
        *(".mraw", ".cine", ".cin", ".seq", ".raw", ".im7", ".b16", ".spe"),
    }
)

# Formats that lose counts: 8 bits, and not the ones that were recorded.
_LOSSY = frozenset({".jpg", ".jpeg", ".jpe"})

# Names that erlif itself writes; what they hold are not frames.
OWN_OUTPUT = frozenset({"figures", "calibration.png", "film.zarr"})

# Levels of folders below the directory that are searched.
DEEPEST = 3

# Files beyond which a directory is refused: it is not that of one run.
MOST_FILES = 200_000

# Size of a CSV file above which it is neither a log nor a profile. [byte]
LARGEST_TABLE = 64 * 2**20

# Pages of a camera whose counts are read for the bit depth.
SAMPLED_PAGES = 12

# Bit depths of cameras that store 16-bit files; dim frames of such a camera fit fewer bits.
USUAL_DEPTHS = (12, 14, 16)

# Share of the frames that a way of naming must explain; the rest are other images, of a scale.
COVERED = 0.8

# Words in the names of images that are no frames.
_PURPOSES = {
    "darks": re.compile(r"(?<![a-z])(dark|dunkel|bias|black)"),
    "flats": re.compile(r"(?<![a-z])(flat|white|uniform)"),
    "backgrounds": re.compile(r"(?<![a-z])(background|bg|dry)(?![a-z])"),
}

# Formats of which a file is a whole recording; parts of others may differ in their number alone.
_MOVIES = frozenset({".avi", ".cine", ".cin", ".mraw", ".seq", ".spe"})

# Words in the names of recordings and folders of a fixture.
_FIXTURE = re.compile(r"(?<![a-z])(wedge|keil|calib|kalib|fixture)")

_CAMERA = re.compile(
    r"(?<![a-z])(?:camera|kamera|cam|channel|ch|c)[ _-]?0?([0-9])(?!\d)"
    r"|(?<![a-z])(?:camera|kamera|cam)[ _-]?([ab])(?![a-z\d])"
)
_WAVELENGTH = re.compile(r"(?<!\d)([4-8]\d\d)(?=[ _-]?nm|[^a-z\d]|$)")  # visible light, in nm

# From the name of a file, relative and in lower case, to the camera it belongs to.
_KeyRule = Callable[[str], str | None]


@dataclass(frozen=True)
class CountsSample:
    """What the counts of some pages show.

    Attributes
    ----------
    pages : int
        Number of pages read.
    highest : int
        Largest count. [DN]
    unused_bits : int
        Low bits that no count sets: 4 where 12-bit counts are stored left-aligned in 16 bits.
    bit_depth : int
        Smallest usual bit depth that holds the counts, unused bits left out.
    full_scale_seen : bool
        Whether several pixels are at the full scale of that depth, which makes it certain.
    stated : bool
        Whether that depth is the one in the headers of the files.
    """

    pages: int
    highest: int
    unused_bits: int
    bit_depth: int
    full_scale_seen: bool
    stated: bool = False


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
    """

    files: tuple[Path, ...]
    pattern: str | None
    pages: int
    kinds: tuple[str, ...]
    faults: tuple[str, ...]
    bits: int | None = None


@dataclass(frozen=True)
class CameraSurvey:
    """What one camera has recorded.

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
    selection : Selection
        Part of the files that belongs to this camera where one file holds both.
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
    selection: Selection = WHOLE
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
    """What lies in a directory.

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
    lossy : tuple[Path, ...]
        JPEG files, which hold no counts.
    left_out : tuple[Path, ...]
        Folders of fixtures, whose images are none of this run.
    """

    directory: Path
    cameras: tuple[CameraSurvey, ...]
    unassigned: tuple[Path, ...]
    tables: tuple[TextTable, ...]
    logs: tuple[Path, ...] = ()
    in_order: tuple[str, ...] = ()
    lossy: tuple[Path, ...] = ()
    left_out: tuple[Path, ...] = ()

    @property
    def lone_darks(self) -> tuple[Path, ...]:
        """Images named as darks that belong to no camera by their names."""
        names = {path: _plain_name(path, self.directory) for path in self.unassigned}
        return tuple(path for path, name in names.items() if _purpose(name) == "darks")


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
    files = list(islice(_walk(directory, DEEPEST), MOST_FILES + 1))
    if len(files) > MOST_FILES:
        raise FrameError(
            f"Expected the directory of one run; {directory} holds more than {MOST_FILES} files. "
            "Name the folder of one run."
        )

    tables = [_read_table(path) for path in sorted(files) if path.suffix.lower() == ".csv"]
    read = tuple(table for table in tables if table is not None)
    images = sorted((path for path in files if _is_image(path)), key=natural_key)
    left_out: list[Path] = []
    if not fixture:
        images, left_out = _leave_out_fixtures(images, directory, read)
    groups, unassigned = _group_by_camera(images, directory)
    in_order = _assign_in_order(groups, unassigned, directory)
    cameras = [
        _choose_recording(_describe_camera(label, group, directory), directory, fixture=fixture)
        for label, group in groups.items()
    ]
    cameras = _drop_common_wavelength(cameras)
    cameras.sort(key=lambda camera: (camera.wavelength or 0, natural_key(Path(camera.label))))
    if len(groups) == 1:
        label, group = groups.popitem()
        separated = _separate(label, group, unassigned, directory, read)
        cameras, unassigned = separated or (cameras, unassigned)

    logs = tuple(path for path in sorted(files) if path.suffix.lower() in LOG_SUFFIXES)
    lossy = tuple(path for path in files if path.suffix.lower() in _LOSSY)
    return Survey(
        directory,
        tuple(cameras),
        tuple(unassigned),
        read,
        logs,
        in_order,
        lossy,
        tuple(left_out),
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


def _is_image(path: Path) -> bool:
    # an HDF5 file may as well be a log
    if path.suffix.lower() in (".h5", ".hdf5"):
        return bool(list_datasets(path))
    return path.suffix.lower() in IMAGE_SUFFIXES


def _read_table(path: Path) -> TextTable | None:
    """Header and length of a CSV file; None where it is none."""
    try:
        rows = read_rows(path, largest=LARGEST_TABLE)
    except (OSError, ValueError):
        return None
    return TextTable(path, tuple(rows[0][1]), len(rows) - 1) if rows else None


def _leave_out_fixtures(
    images: list[Path], directory: Path, tables: Sequence[TextTable]
) -> tuple[list[Path], list[Path]]:
    """Images outside the folders of fixtures, and these folders; all where no frames are left."""
    profiles = {table.path.parent for table in tables if set(table.header) >= PROFILE}
    inside: dict[Path, Path] = {}
    for path in images:
        for folder in path.parents[: len(path.relative_to(directory).parts) - 1]:
            settings = (folder / "fixture.toml").is_file()
            if settings or folder in profiles or _FIXTURE.search(folder.name.lower()):
                inside[path] = folder
    rest = [path for path in images if path not in inside]
    if not any(_purpose(_plain_name(path, directory)) == "frames" for path in rest):
        return images, []
    return rest, list(dict.fromkeys(inside.values()))


# names


def _group_by_camera(
    images: Sequence[Path], directory: Path
) -> tuple[dict[str, dict[str, list[Path]]], list[Path]]:
    """Files by camera and purpose ("frames", "darks", ...), and those of no camera."""
    names = {path: _plain_name(path, directory) for path in images}
    purposes = {path: _purpose(name) for path, name in names.items()}
    frames = [path for path in images if purposes[path] == "frames"]
    rule = _choose_rule([names[path] for path in frames])

    groups: dict[str, dict[str, list[Path]]] = {}
    unassigned: list[Path] = []
    for path in frames:
        label = rule(names[path])
        if label is None:
            unassigned.append(path)
        else:
            groups.setdefault(label, defaultdict(list))["frames"].append(path)

    # darks and flats may lie elsewhere, "darks/left.tif", "dark_left.tif": there the label, or a
    # word of the names of one camera alone, is looked for in the name
    words = {one: _words(one) for one in groups}
    common = set.intersection(*words.values()) if words else set()
    for path in images:
        if purposes[path] == "frames":
            continue
        label = rule(names[path])
        named = [one for one in groups if (words[one] - common) & _words(names[path])]
        named = named or [one for one in groups if one in names[path]]
        if label not in groups and len(named) == 1:
            label = named[0]
        if label in groups:
            groups[label][purposes[path]].append(path)
        else:
            unassigned.append(path)
    return groups, unassigned


def _assign_in_order(
    groups: dict[str, dict[str, list[Path]]], unassigned: list[Path], directory: Path
) -> tuple[str, ...]:
    """Give two lone sets of darks or flats to the two cameras, in the order of the names.

    The files are moved from `unassigned` into `groups`; the purposes for which this was done are
    returned.
    """
    if len(groups) != 2:
        return ()
    done = []
    for purpose in ("darks", "flats"):
        lone = {path: _plain_name(path, directory) for path in unassigned}
        lone = {path: name for path, name in lone.items() if _purpose(name) == purpose}
        if any(group.get(purpose) for group in groups.values()):
            continue
        rule = _choose_rule(list(lone.values()))
        labels = {path: str(rule(name)) for path, name in lone.items()}
        if len(lone) == 2:  # a file for each camera, whatever they are called
            labels = lone
        if len(set(labels.values())) != 2:
            continue
        cameras, sets = (
            sorted(each, key=lambda label: natural_key(Path(label)))
            for each in (groups, set(labels.values()))
        )
        for path, label in labels.items():
            groups[cameras[sets.index(label)]][purpose].append(path)
            unassigned.remove(path)
        done.append(purpose)
    return tuple(done)


def _plain_name(path: Path, directory: Path) -> str:
    """Name in the directory, in lower case and with "Cam1Dark" written as "cam1_dark"."""
    name = path.relative_to(directory).with_suffix("").as_posix()
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def _words(name: str) -> set[str]:
    return set(re.findall("[a-z]+", name))


def _purpose(name: str) -> str:
    purposes = (purpose for purpose, words in _PURPOSES.items() if words.search(name))
    return next(purposes, "frames")


def _choose_rule(names: Sequence[str]) -> _KeyRule:
    """The first way of naming that distinguishes two cameras, else the one that finds fewest."""
    rules = (_camera_number, _wavelength_key, _folder, _prefix)
    best: _KeyRule = _one_camera
    fewest = 1 << 30
    for rule in rules:
        labels = [label for name in names if (label := rule(name)) is not None]
        groups = len(set(labels))
        if len(labels) < COVERED * len(names) or not groups:
            continue
        if groups == 2:
            return rule
        if groups < fewest:
            best, fewest = rule, groups
    return best


def _camera_number(name: str) -> str | None:
    match = _CAMERA.search(name)
    return f"camera {match[1] or match[2]}" if match else None


def _wavelength_key(name: str) -> str | None:
    match = _WAVELENGTH.search(name)
    return match[1] if match else None


def _folder(name: str) -> str | None:
    folder, _, _ = name.rpartition("/")
    return folder or None


def _prefix(name: str) -> str | None:
    return re.sub(r"[ _-]*\d+$", "", name) or None


def _one_camera(name: str) -> str | None:
    return "frames"


# images


def _separate(
    label: str,
    group: dict[str, list[Path]],
    unassigned: Sequence[Path],
    directory: Path,
    tables: Sequence[TextTable],
) -> tuple[list[CameraSurvey], list[Path]] | None:
    """Both cameras of files that hold two, and the files of neither; else None."""
    shared = find_cameras_in_file(group["frames"][0], [table.rows for table in tables])
    if shared is None:
        return None

    # no name has to name a camera where one file of darks holds both
    rest: list[Path] = []
    for path in unassigned:
        purpose = _purpose(_plain_name(path, directory))
        (rest if purpose == "frames" else group[purpose]).append(path)
    cameras = []
    for number, value in enumerate(shared.values):
        if shared.key == "part":
            selection = Selection(part=value)
            camera = _describe_camera(f"{label} {value}", group, directory, selection)
        else:
            camera = _describe_camera(value, group, directory, Selection(dataset=value))
            camera = _add_datasets(camera, shared, number, directory)
        cameras.append(replace(camera, shared=shared))
    return cameras, rest


def _add_datasets(
    camera: CameraSurvey, shared: SharedFile, number: int, directory: Path
) -> CameraSurvey:
    """Darks and flats that lie in the file of the frames."""

    def describe(names: tuple[str, str] | None) -> ImageSet | None:
        if names is None:
            return None
        chosen = Selection(dataset=names[number])
        return _describe_set(camera.frames.files, directory, chosen)[0]

    return replace(camera, darks=describe(shared.darks), flats=describe(shared.flats))


def _describe_camera(
    label: str, group: dict[str, list[Path]], directory: Path, selection: Selection = WHOLE
) -> CameraSurvey:
    """Read the headers of a camera's files, and the counts of some."""
    sets = {
        purpose: _describe_set(files, directory, selection)
        for purpose, files in group.items()
        if files
    }
    frames, pages = sets["frames"]
    darks, flats, dry = (sets[name][0] if name in sets else None for name in _PURPOSES)

    # flats are brighter than many a film: they show bits that the frames do not set
    bright = _spread(sets["flats"][1]) if "flats" in sets else []
    return CameraSurvey(
        label=label,
        wavelength=_common_wavelength([_plain_name(path, directory) for path in group["frames"]]),
        frames=frames,
        darks=darks,
        flats=flats,
        backgrounds=dry,
        counts=_sample_counts([*_spread(pages), *bright], directory, frames.bits),
        selection=selection,
    )


def _choose_recording(camera: CameraSurvey, directory: Path, *, fixture: bool) -> CameraSurvey:
    """One of several recordings of a camera, by the words in their names, else the longest."""
    files = camera.frames.files
    parts: dict[str, list[Path]] = defaultdict(list)
    for path in files:
        name = path.stem if path.suffix.lower() in _MOVIES else re.sub(r"\d+", "#", path.stem)
        parts[name].append(path)
    if len(parts) < 2:
        return camera

    # a file of a single image is no recording
    described = [_describe_set(part, directory) for part in parts.values()]
    if any(one.pages < 2 * len(one.files) for one, _ in described):
        return camera
    wanted = [pair for pair in described if names_fixture(pair[0]) == fixture] or described
    frames, pages = max(wanted, key=lambda pair: pair[0].pages)
    return replace(
        camera,
        frames=frames,
        counts=_sample_counts(_spread(pages), directory, frames.bits) or camera.counts,
        recordings=tuple(one for one, _ in described),
        chosen=len(wanted) == 1,
    )


def names_fixture(images: ImageSet) -> bool:
    """Whether the name of a recording is that of a fixture.

    Examples
    --------
    >>> names_fixture(ImageSet((Path("Cam_580nm_wedge.cine"),), None, 6, (), ()))
    True
    """
    return bool(_FIXTURE.search(_plain_name(images.files[0], images.files[0].parent)))


def _describe_set(
    files: Sequence[Path], directory: Path, selection: Selection = WHOLE
) -> tuple[ImageSet, list[tuple[Page, tuple[int, ...]]]]:
    """Headers of the files, and the readable grey pages with their shapes."""
    headers = read_headers(files, selection)
    faults = [
        f"{os.path.relpath(headers.pages[k].path, directory)}: {reason}"
        for k, reason in headers.faults.items()
    ]
    readable = [
        (page, kind)
        for k, (page, kind) in enumerate(zip(headers.pages, headers.kinds, strict=True))
        if k not in headers.faults
    ]
    kinds = Counter(str(kind) for _, kind in readable)
    described = ImageSet(
        tuple(files),
        _find_pattern(files, directory),
        len(headers.pages),
        tuple(kind for kind, _ in kinds.most_common()),
        tuple(faults),
        headers.bits,
    )
    return described, [(page, kind.shape) for page, kind in readable]


def _find_pattern(files: Sequence[Path], directory: Path) -> str | None:
    """The shortest pattern that matches these files and no others."""
    if len(files) == 1:
        return glob.escape(files[0].relative_to(directory).as_posix())

    # what the names share: folder, beginning, end and suffix
    common = Path(os.path.commonpath([path.parent for path in files])).relative_to(directory)
    start = glob.escape(common.as_posix()) + "/" if common.parts else ""
    suffixes = sorted({path.suffix for path in files})
    end = suffixes[0] if len(suffixes) == 1 else ".*"

    prefix = glob.escape(_common_start([path.name for path in files]).rstrip("0123456789"))
    folders = glob.escape(_common_start([path.parent.name for path in files]))
    ending = glob.escape(_common_start([path.stem[::-1] for path in files])[::-1])

    # from the plainest to the most special; darks and flats may lie among the frames
    candidates = [
        f"{start}*{end}",
        f"{start}{prefix}*{end}",
        f"{start}{prefix}[0-9]*{end}",
        f"{start}*/*{end}",
        f"{start}{folders}*/*{end}",
        f"{start}**/{prefix}*{end}",
        f"{start}*{ending}{end}",
    ]
    wanted = set(files)
    for pattern in candidates:
        if set(match_files(directory, pattern)) == wanted:
            return pattern
    return None


def _common_start(texts: Sequence[str]) -> str:
    """Longest text with which all begin."""
    return os.path.commonprefix(texts)  # noqa: RUF071 - letter by letter, as is meant


def _spread(pages: Sequence[tuple[Page, tuple[int, ...]]]) -> list[tuple[Page, tuple[int, ...]]]:
    """A few pages, evenly over all."""
    step = max(len(pages) // SAMPLED_PAGES, 1)
    return list(pages[::step])


def _sample_counts(
    pages: Sequence[tuple[Page, tuple[int, ...]]], directory: Path, stated: int | None
) -> CountsSample | None:
    """Largest count, unused bits and bit depth of some pages."""
    highest, used, levels, read, wide = 0, 0, 0, 0, False
    top: Counter[int] = Counter()  # number of pixels at the largest count of a page
    for page, shape in pages:
        try:
            counts = read_page(page, directory, shape)
        except FrameError:
            continue
        highest = max(highest, int(counts.max()))
        used |= int(np.bitwise_or.reduce(counts, axis=None))
        levels = max(levels, np.unique(counts).size)
        wide = wide or counts.dtype.itemsize > 1
        top[int(counts.max())] += int((counts == counts.max()).sum())
        read += 1
    if not read or not used:
        return None

    # in an image of few levels, low bits that are never set may be chance
    unused = count_padding(used) if levels > FEW_LEVELS else 0

    bits = (highest >> unused).bit_length()
    depth = next(depth for depth in (USUAL_DEPTHS if wide else (8,)) if bits <= depth)
    # dim frames fit fewer bits than the camera has, which its header states
    fits = stated is not None and bits <= stated and not unused
    depth = stated if stated is not None and fits else depth
    full_scale = ((1 << depth) - 1) << unused
    return CountsSample(read, highest, unused, depth, top[full_scale] > 1, fits)


def _common_wavelength(names: Sequence[str]) -> int | None:
    """Wavelength that stands in all names of a camera, if there is exactly one."""
    shared = set.intersection(*(set(_WAVELENGTH.findall(name)) for name in names))
    return int(shared.pop()) if len(shared) == 1 else None


def _drop_common_wavelength(cameras: Sequence[CameraSurvey]) -> list[CameraSurvey]:
    """A number that all cameras share is none of a filter ("run_500")."""
    wavelengths = {camera.wavelength for camera in cameras}
    if len(wavelengths) == len(cameras) and None not in wavelengths:
        return list(cameras)
    return [replace(camera, wavelength=None) for camera in cameras]
