"""Image files: their pages, the shape and type in each header, their counts."""

from __future__ import annotations

import glob
import hashlib
import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from erlif.core.arrays import AnyArray, Array, Counts
from erlif.core.errors import FrameError
from erlif.core.guarded import file_stamp
from erlif.core.notes import Note, warn
from erlif.io.ingest.counts import (
    FEW_LEVELS,
    STORED_TYPES,
    align_right,
    convert_counts,
    count_padding,
)
from erlif.io.ingest.order import sort_files
from erlif.io.ingest.selection import WHOLE, Selection
from erlif.io.readers import FrameKind, borrow_frames, open_frames
from erlif.io.readers.base import TRUNCATED, describe_shape


@dataclass(frozen=True)
class Page:
    """One image in a file.

    Attributes
    ----------
    path : Path
        File that holds the image.
    index : int
        Position in a multi-page file, counted from 0.
    alone : bool
        Whether the file is known to hold no other image.
    selection : Selection
        Part of the image that belongs to the camera.
    """

    path: Path
    index: int
    alone: bool = field(default=False, compare=False)
    selection: Selection = WHOLE

    @property
    def name(self) -> str:
        """File name in UTF-8, with the index from the second page on."""
        # a name may hold any bytes, a message and a netCDF file only text
        name = os.fsencode(self.path.name).decode(errors="replace")
        return name if self.index == 0 else f"{name}[{self.index}]"


def name_page(page: Page, directory: Path, camera: int) -> str:
    """Name of a page in a message: its place in the directory, and its camera, 1 or 2.

    The folder names the camera where it has the name of its table in the settings.
    """
    inside = page.path.is_relative_to(directory)
    folder = (page.path.relative_to(directory) if inside else page.path).parent
    place = Path(os.fsencode(folder).decode(errors="replace"), page.name).as_posix()
    return place if f"camera{camera}" in folder.parts else f"{place} of camera {camera}"


def is_one_file(pages: Sequence[Page]) -> bool:
    """Whether all frames of a camera lie in one file."""
    return len(pages) > 1 and pages[0].path == pages[-1].path


# Stands for a page whose header or data is damaged.
UNREADABLE = FrameKind((0, 0), "unreadable")


class PageContent(NamedTuple):
    """Counts of one page, with the hash of its file.

    Attributes
    ----------
    counts : Counts
        (y, x), uint8 or uint16. [DN]
    digest : str
        SHA-256 of the file, hexadecimal; empty where other pages or readers share the file.
    """

    counts: Counts
    digest: str = ""


@dataclass
class CameraFiles:
    """The pages of one camera in natural order.

    Attributes
    ----------
    pages : list[Page]
        Images of all files, unreadable ones included.
    kinds : list[FrameKind]
        Kind of each page; UNREADABLE for damaged ones.
    faults : dict[int, str]
        Reasons why pages are unreadable, by position.
    times : Array | None
        Time of each page from the first one, (page,); None where no header has it. [s]
    companions : list[Path]
        Other files that hold a part of the recording, such as the header beside raw data.
    bits : int | None
        Significant bits of a count after the headers; None where they state none, or differ.
    warning : str
        Why the counts of a format are doubtful; empty where they are not.
    start : float
        Time of the first page on the clock of its file; 0 where no header has it. [s]
    serial : str
        Serial number of the camera; empty where no header has it.
    """

    pages: list[Page] = field(default_factory=list)
    kinds: list[FrameKind] = field(default_factory=list)
    faults: dict[int, str] = field(default_factory=dict)
    times: Array | None = None
    companions: list[Path] = field(default_factory=list)
    bits: int | None = None
    warning: str = ""
    start: float = 0.0
    serial: str = ""


def match_files(directory: Path, pattern: str, *, known: Collection[str] = ()) -> list[Path]:
    """Files that a pattern of the settings matches, in natural order.

    Hidden files are left out, and those whose names relative to the directory are `known`.
    """
    # a folder may be called "camera1 [580 nm]"
    names = glob.glob(pattern, root_dir=directory, recursive=True)
    names = names or glob.glob(pattern.replace("[", "[[]"), root_dir=directory, recursive=True)
    paths = (directory / name for name in names if name not in known)
    return sort_files(path for path in paths if not path.is_dir())


def find_pages(
    directory: Path, pattern: str, what: str, selection: Selection = WHOLE
) -> CameraFiles:
    """Find the pages that match a pattern and read their headers.

    Parameters
    ----------
    directory : Path
    pattern : str
        File name or glob, relative to `directory`.
    what : str
        Name of the pages in messages, such as "camera1 dark".
    selection : Selection
        Part of the files that belongs to the camera.

    Returns
    -------
    CameraFiles
        Unreadable pages are listed in its faults and do not raise.

    Raises
    ------
    FrameError
        If no file matches.
    """
    paths = match_files(directory, pattern)
    if not paths:
        there = "it is a folder" if (directory / pattern).is_dir() else "there is none"
        raise FrameError(
            f"Expected files {pattern} of {what} in {directory}; {there}. Put them there, or "
            "correct the name in the settings."
        )
    found = read_headers(paths, selection)
    _check_order(found, what)
    return found


def _check_order(found: CameraFiles, what: str) -> None:
    """Refuse images that are not wide, where nothing shows that they are not transposed."""
    for page, kind in zip(found.pages, found.kinds, strict=True):
        if page.selection.array_order == "unknown" and kind.shape[0] >= kind.shape[1]:
            table = what.split()[0]
            raise FrameError(
                f"Expected the order of the axes of {page.path.name}, {what}; its images are "
                f"{describe_shape(kind.shape)}, and MATLAB's h5write, Julia, R and Fortran write "
                f'them transposed. Give array_order = "column" in [{table}] if one of them wrote '
                'it, else array_order = "row".'
            )


def read_headers(paths: Sequence[Path], selection: Selection = WHOLE) -> CameraFiles:
    """Pages of files in their order, by the headers; unreadable ones are among its faults.

    Parameters
    ----------
    paths : sequence of Path
    selection : Selection
        Part of the files that belongs to the camera.

    Returns
    -------
    CameraFiles
    """
    read = CameraFiles()
    depths: set[int | None] = set()
    times: list[Array | None] = []
    for path in paths:
        # a pattern may match a file of counts and the header beside it, which are one recording
        if path in read.companions:
            continue
        try:
            file = _read_header(path, selection)
            depths.add(file.bits)
        except FrameError as error:
            # kept as one page, so that the frames after it keep their numbers
            page = Page(path, 0, selection=selection)
            file = CameraFiles([page], [UNREADABLE], {0: str(error)})

        read.start = read.start if read.pages else file.start
        read.faults |= {len(read.pages) + k: reason for k, reason in file.faults.items()}
        read.pages += file.pages
        read.kinds += file.kinds
        read.companions += file.companions
        read.serial = read.serial or file.serial
        times.append(file.times)
    read.bits = depths.pop() if len(depths) == 1 else None

    # the clocks of two recordings may have started at different times
    read.times = times[0] if len(times) == 1 else None
    return read


def read_page(page: Page, directory: Path, shape: tuple[int, ...]) -> Counts:
    """Decode the counts of one page.

    Parameters
    ----------
    page : Page
    directory : Path
        The run or fixture directory, for messages.
    shape : (rows, columns)
        Shape of all frames of the recording.

    Returns
    -------
    array of uint8 or uint16, (y, x)
        [DN]

    Raises
    ------
    FrameError
        If the file cannot be decoded, or holds another shape or type.
    """
    return read_content(page, directory, shape).counts


def read_content(
    page: Page, directory: Path, shape: tuple[int, ...], *, digest: bool = False
) -> PageContent:
    """Decode the counts of one page, and hash the file as it is read.

    Arguments and errors as in `read_page`; `digest` asks for the hash.

    Returns
    -------
    PageContent
    """
    name = os.path.relpath(page.path, directory) + (f"[{page.index}]" if page.index else "")
    try:
        content = _decode(page, digest=digest)
    except (Exception, SystemExit) as error:  # decoders of damaged bytes may raise anything
        raise FrameError(
            f"Expected an image in {name}; it cannot be decoded: {with_advice(str(error))}"
        ) from error

    image = content.counts
    _check_kind(FrameKind(image.shape, image.dtype.name), shape, name)
    try:
        counts = align_right(convert_counts(image), page.selection.shift)
    except FrameError as error:
        raise FrameError(f"Expected counts in {name}; {error}") from error
    return PageContent(counts, content.digest)


def _decode(page: Page, *, digest: bool) -> PageContent:
    """Image of a page as it is stored; the hash belongs to the bytes that are decoded."""
    if not digest or not page.alone:
        return PageContent(page.selection.crop(_read_frame(page)))

    before = file_stamp(page.path)
    with page.path.open("rb") as file:
        hashed = hashlib.file_digest(file, "sha256").hexdigest()
    image = _read_frame(page)
    if file_stamp(page.path) != before:
        raise FrameError("the file has changed while it was read")
    return PageContent(page.selection.crop(image), hashed)


def _read_frame(page: Page) -> AnyArray:
    with borrow_frames(page.path, dataset=page.selection.dataset) as file:
        return file.read(page.index)


_SKIP = "Record it again, or use --skip-bad-frames to leave out this frame pair."


def with_advice(reason: str, advice: str = _SKIP) -> str:
    """Append the advice to the reason why a page is unreadable, unless it contains one."""
    return reason if reason.endswith(".") else f"{reason}. {advice}"


def check_depth(counts: Counts, *, bit_depth: int, name: str) -> None:
    """Refuse counts that do not fit the bit depth of the camera.

    Parameters
    ----------
    counts : array, (y, x)
        [DN]
    bit_depth : int
        Bits per pixel in the settings.
    name : str
        Name of the page in messages.

    Raises
    ------
    FrameError
        If counts exceed full scale, or are left-aligned: saturation would then go unnoticed.
    """
    # left-aligned counts are reported first: their largest count exceeds full scale as well
    full_scale = (1 << bit_depth) - 1
    top = int(counts.max())
    set_bits = int(np.bitwise_or.reduce(counts, axis=None))
    unused = count_padding(set_bits)
    if unused and np.unique(counts).size > FEW_LEVELS:
        container = 16 if top > full_scale else bit_depth
        depth = container - unused
        todo = (
            f'Set alignment = "left" and bit_depth = {depth}.'
            if container == 16
            else f"Divide the counts by {1 << unused}, save them again and set bit_depth = {depth}."
        )
        raise FrameError(
            f"Expected counts of {bit_depth} bits; {name} holds multiples of {1 << unused} up to "
            f"{top}: {depth}-bit counts, left-aligned. {todo}"
        )
    if top > full_scale:
        fits = f"bit_depth = {top.bit_length()} fits"
        if int(counts.min()) >= 65535 - full_scale > full_scale:
            fits += ", or 16 bits are stored inverted (MINISWHITE)"
        raise FrameError(
            f"Expected counts up to {full_scale} (bit_depth = {bit_depth}); {name} reaches {top}: "
            f"{fits}. Set the bit depth of the camera."
        )


def depth_warning(highest: int, *, bit_depth: int, camera: int) -> Note | None:
    """Warn where no count of a run comes near full scale.

    Parameters
    ----------
    highest : int
        Highest count of the run. [DN]
    bit_depth : int
        Bits per pixel in the settings.
    camera : int
        1 or 2.

    Returns
    -------
    Note or None
        A warning where the highest count is at most a sixteenth of full scale.

    Examples
    --------
    >>> depth_warning(4000, bit_depth=12, camera=1) is None
    True
    >>> print(depth_warning(200, bit_depth=12, camera=1).text[:29])
    no count is above 200 of 4095
    """
    full_scale = (1 << bit_depth) - 1
    if highest > full_scale // 16:
        return None
    return warn(
        f"camera{camera}",
        f"no count is above {highest} of {full_scale} (bit_depth = {bit_depth}); "
        f"bit_depth = {max(8, highest.bit_length())} would fit, or the light is very low.",
    )


def _read_header(path: Path, selection: Selection) -> CameraFiles:
    """Pages of a file that belong to a camera; FrameError with the bare reason."""
    with closing(open_frames(path, dataset=selection.dataset)) as file:
        order = file.array_order and (selection.array_order or file.array_order)
        if order != selection.array_order:
            selection = replace(selection, array_order=order)
        places = selection.pages(file)
        alone = len(file.kinds) == 1 and not file.companions
        kinds = [file.kinds[k] for k in places]
        crops = {
            kind: FrameKind(selection.crop_shape(kind.shape), kind.dtype) for kind in set(kinds)
        }
        crops[TRUNCATED] = UNREADABLE

        # time stamps with gaps are as good as none
        times = file.times
        if times is not None and (len(times) != len(file.kinds) or not np.isfinite(times).all()):
            times = None
        return CameraFiles(
            [Page(path, k, alone, selection) for k in places],
            [crops[kind] for kind in kinds],
            {n: "the file is truncated" for n, kind in enumerate(kinds) if kind == TRUNCATED},
            None if times is None else times[places] - times[places[0]],
            list(file.companions),
            file.bits,
            start=0.0 if times is None else float(times[places[0]]),
            serial=file.serial,
        )


def _check_kind(kind: FrameKind, shape: tuple[int, ...], name: str) -> None:
    """Refuse an image of another shape or type than the frames have."""
    if kind.shape != shape or kind.dtype not in STORED_TYPES:
        wanted, found = describe_shape(shape), describe_shape(kind.shape)
        raise FrameError(
            f"Expected grey counts of {wanted} pixels in {name}; it is {kind.dtype} of {found}. "
            "Record frames, darks and flats with the same region of interest."
        )


def read_reference_pages(
    directory: Path,
    pattern: str,
    *,
    what: str,
    bit_depth: int,
    shape: tuple[int, int],
    selection: Selection = WHOLE,
) -> Iterator[Counts]:
    """Read the pages of a dark or flat recording.

    Arguments as in `find_pages`, and bits per pixel and shape [px] of the frames they belong to.

    Yields
    ------
    array, (y, x)
        Counts of one page. [DN]

    Raises
    ------
    FrameError
        If no file matches, a page is unreadable, or its shape, type or counts do not fit.

    Examples
    --------
    >>> pages = read_reference_pages(
    ...     Path("calibration/wedge"), "camera1_dark.tif",
    ...     what="camera1 dark", bit_depth=12, shape=(208, 256),
    ... )
    >>> next(pages).shape
    (208, 256)
    """
    # headers of all pages first: a fault in the last one is reported before any work
    references = find_pages(directory, pattern, what, selection)
    if references.faults:
        first = min(references.faults)
        reason = with_advice(references.faults[first], "Record them again, or take the file out.")
        raise FrameError(
            f"Expected readable {what} pages; {references.pages[first].name}: {reason}"
        )

    for page, kind in zip(references.pages, references.kinds, strict=True):
        _check_kind(kind, shape, page.name)
    for page in references.pages:
        counts = read_page(page, directory, shape)
        check_depth(counts, bit_depth=bit_depth, name=page.name)
        yield counts
