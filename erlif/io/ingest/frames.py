"""Frame pairs: what both cameras recorded of the same laser pulses."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from erlif.core.arrays import Array, Counts, Mask
from erlif.core.notes import Note, list_some, remark, warn
from erlif.core.products import Frames
from erlif.io.ingest.exclusions import exclusion_notes
from erlif.io.ingest.images import Page, PageContent, check_depth, name_page, read_content

# Files of many frames that a note names.
_MOST_NAMED = 6


@dataclass(frozen=True)
class FramePairs:
    """The frames of two cameras, paired; files are read when frames are asked for.

    Attributes
    ----------
    directory : Path
        The run or fixture directory.
    pages : tuple[tuple[Page, ...], tuple[Page, ...]]
        Frame k of camera 1 and frame k of camera 2 belong to the same laser pulse.
    shape : tuple[int, int]
        (rows, columns) of every frame. [px]
    bit_depths : tuple[int, int]
        Bits per pixel of camera 1 and camera 2.
    skipped : dict[int, str]
        Frame pairs left out, with the reason.
    times : Array | None
        Time of each frame pair from the first one by the header of camera 1, else of camera 2,
        (frame,); None where no header has it. [s]
    companions : tuple[tuple[Path, ...], tuple[Path, ...]]
        Other files of camera 1 and camera 2 that hold a part of the recording.
    warnings : tuple[str, str]
        Why the format of camera 1 and camera 2 is doubtful; empty where it is not.
    stated_bits : tuple[int | None, int | None]
        Significant bits of a count after the headers; None where they state none.
    serials : tuple[str, str]
        Serial numbers of the cameras after the headers; empty where they have none.
    excluded : Mask | None
        True for the pixels of camera 1 that count nowhere, (y, x); None where all do.
    """

    directory: Path
    pages: tuple[tuple[Page, ...], tuple[Page, ...]]
    shape: tuple[int, int]
    bit_depths: tuple[int, int]
    skipped: dict[int, str] = field(default_factory=dict)
    times: Array | None = field(default=None, compare=False)
    companions: tuple[tuple[Path, ...], tuple[Path, ...]] = ((), ())
    warnings: tuple[str, str] = ("", "")
    stated_bits: tuple[int | None, int | None] = (None, None)
    serials: tuple[str, str] = ("", "")
    excluded: Mask | None = field(default=None, compare=False)

    @property
    def usable(self) -> list[int]:
        """Numbers of the frame pairs that can be used, counted from 0."""
        return [k for k in range(len(self.pages[0])) if k not in self.skipped]

    @property
    def date(self) -> str:
        """Day on which the first frame was written: the same for the same files at any time."""
        epoch = os.environ.get("SOURCE_DATE_EPOCH")
        stamp = float(epoch) if epoch else self.pages[0][0].path.stat().st_mtime
        return datetime.fromtimestamp(stamp, UTC).date().isoformat()

    @property
    def full_scales(self) -> tuple[int, int]:
        """Largest possible count of camera 1 and camera 2. [DN]"""
        one, two = self.bit_depths
        return (1 << one) - 1, (1 << two) - 1

    def spread(self, count: int) -> list[int]:
        """Numbers of at most `count` usable frame pairs, evenly spaced over the recording."""
        # rounding may choose a frame twice where there are few
        usable = self.usable
        places = np.unique(np.linspace(0, len(usable) - 1, count).round().astype(int))
        return [usable[place] for place in places]


class PairCounts(NamedTuple):
    """Counts of one frame pair, with the hashes of their files.

    Attributes
    ----------
    counts : tuple[Counts, Counts]
        Camera 1 and camera 2, each (y, x), uint16. [DN]
    digests : tuple[str, str]
        SHA-256 of both files, hexadecimal; empty where it is not asked for, or where a file holds
        more than one frame.
    """

    counts: tuple[Counts, Counts]
    digests: tuple[str, str]


def read_pair(pairs: FramePairs, frame: int, *, digests: bool = False) -> PairCounts:
    """Read one frame pair as plain arrays.

    Parameters
    ----------
    pairs : FramePairs
    frame : int
        Frame number, counted from 0.
    digests : bool
        Whether the files are hashed as they are read.

    Returns
    -------
    PairCounts

    Raises
    ------
    FrameError
        As `read_frames`.

    Examples
    --------
    >>> import tempfile, tifffile
    >>> directory = Path(tempfile.mkdtemp())
    >>> tifffile.imwrite(directory / "one.tif", np.full((2, 3), 7, np.uint16))
    >>> page = Page(directory / "one.tif", 0)
    >>> pairs = FramePairs(directory, ((page,), (page,)), (2, 3), (12, 12))
    >>> read_pair(pairs, 0).counts[1][0]
    array([7, 7, 7], dtype=uint16)
    """
    one, two = (_read_page(pairs, camera, frame, digests=digests) for camera in range(2))
    return PairCounts((one.counts, two.counts), (one.digest, two.digest))


def _read_page(pairs: FramePairs, camera: int, frame: int, *, digests: bool) -> PageContent:
    """Read one frame of camera 0 or 1 and check its bit depth."""
    page = pairs.pages[camera][frame]
    content = read_content(page, pairs.directory, pairs.shape, digest=digests)

    # every page is checked again: the header does not show a wrong bit depth
    name = name_page(page, pairs.directory, camera + 1)
    check_depth(content.counts, bit_depth=pairs.bit_depths[camera], name=name)
    return content._replace(counts=content.counts.astype(np.uint16, copy=False))


def read_frames(pairs: FramePairs, frames: Sequence[int]) -> Frames:
    """Read frame pairs.

    Arguments as in `read_pair`, with the numbers of several frames.

    Returns
    -------
    Frames
        counts (camera, frame, y, x) [DN].

    Raises
    ------
    FrameError
        If a file cannot be decoded, or counts do not fit the camera's bit depth.

    Examples
    --------
    >>> from erlif.io.ingest import open_run
    >>> run = open_run(Path("data_samples/straight_bushing"))
    >>> read_frames(run.pairs, [0, 4]).counts.dims
    ('camera', 'frame', 'y', 'x')
    """
    counts = np.empty((2, len(frames), *pairs.shape), np.uint16)
    for n, k in enumerate(frames):
        counts[:, n] = read_pair(pairs, k).counts

    attrs = {"units": "DN", "long_name": "raw counts"}
    coordinates = {"camera": [1, 2], "frame": np.asarray(frames, np.int64)}
    return Frames(
        xr.Dataset({"counts": (("camera", "frame", "y", "x"), counts, attrs)}, coordinates)
    )


def skipped_notes(pairs: FramePairs) -> list[Note]:
    """Notes on the frame pairs that were left out, with the reason.

    Pairs that follow each other and have the same reason share a note.

    Parameters
    ----------
    pairs : FramePairs

    Returns
    -------
    list of Note

    Examples
    --------
    >>> pairs = FramePairs(Path(), ((), ()), (64, 64), (12, 12), {3: "the file is empty"})
    >>> print(skipped_notes(pairs)[0])
    frame pair 3 left out: the file is empty
    """
    rows = sorted(pairs.skipped.items())
    notes = []
    for _, alike in groupby(enumerate(rows), _kind_of_omission):
        part = [row for _, row in alike]
        (first, reason), (last, _) = part[0], part[-1]
        more = f", and {len(part) - 1} more" if len(part) > 1 else ""
        places = f"frame pairs {first} to {last}" if more else f"frame pair {first}"
        notes.append(warn(f"{places} left out", reason + more))
    return notes


def _kind_of_omission(numbered: tuple[int, tuple[int, str]]) -> tuple[int, str, str]:
    """Grouping key of omitted pairs: equal for pairs in a row with one folder and reason."""
    place, (frame, reason) = numbered
    name, _, why = reason.rpartition(": ")
    return frame - place, name.partition("/")[0], why


def format_notes(pairs: FramePairs) -> list[Note]:
    """Doubtful counts, headers with fewer bits, order of several files, and excluded pixels.

    Argument as in `skipped_notes`.

    Returns
    -------
    list of Note

    Examples
    --------
    >>> pairs = FramePairs(Path(), ((), ()), (64, 64), (8, 8), warnings=("", "no counts"))
    >>> print(*format_notes(pairs))
    camera2: no counts
    """
    notes = [
        warn(f"camera{camera}", warning)
        for camera, warning in enumerate(pairs.warnings, 1)
        if warning
    ]

    for camera, pages in enumerate(pairs.pages, 1):
        if pages and pages[0].selection.array_order == "unknown":
            text = (
                "HDF5 taken as (frame, y, x); what MATLAB's h5write, Julia, R or Fortran wrote "
                f'needs array_order = "column" in [camera{camera}]'
            )
            notes.append(remark(f"camera{camera}", text))

        # files of many frames are put in order by their names, which few programs write alike
        files = dict.fromkeys(page.path.name for page in pages)
        if 1 < len(files) < len(pages):
            order = list_some(files, most=_MOST_NAMED)
            notes.append(remark(f"camera{camera}", f"frames of the files in this order: {order}"))

    # a header may state the bits stored in place of those of a count; the depth is then lower
    for camera, (stated, declared) in enumerate(
        zip(pairs.stated_bits, pairs.bit_depths, strict=True), 1
    ):
        if stated is not None and stated < declared:
            text = (
                f"the headers of the files state {stated} bits, run.toml or fixture.toml has "
                f"bit_depth = {declared}: counts at {(1 << stated) - 1} would be saturated and not "
                f"flagged. Set bit_depth = {stated}, if that is the camera's"
            )
            notes.append(warn(f"camera{camera}", text))
    return notes + exclusion_notes(pairs.excluded)
