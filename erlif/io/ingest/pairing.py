"""Frames of two cameras paired by laser pulse, and checked against one another."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from erlif.core.arrays import Counts
from erlif.core.errors import ErlifError, FrameError
from erlif.core.notes import list_some
from erlif.io.ingest.alternation import check_turns
from erlif.io.ingest.counts import STORED_TYPES, find_stamp
from erlif.io.ingest.frames import FramePairs
from erlif.io.ingest.images import (
    UNREADABLE,
    CameraFiles,
    Page,
    check_depth,
    find_pages,
    is_one_file,
    name_page,
    read_page,
    with_advice,
)
from erlif.io.ingest.numbering import MOST_UNEQUAL, common_numbers, frame_numbers, pad_lost
from erlif.io.ingest.selection import WHOLE, Selection, may_share_files
from erlif.io.readers import FrameKind
from erlif.io.readers.base import describe_shape

# Least width and height of a frame: registration needs several windows along each axis. [px]
_SMALLEST = 64

# Difference of the times of two channels from which on they are no pair: stamps have 1 us. [s]
_TOGETHER = 2e-6


def pair_cameras(
    directory: Path,
    patterns: tuple[str, str],
    *,
    bit_depths: tuple[int, int],
    selections: tuple[Selection, Selection] = (WHOLE, WHOLE),
    skip_bad_frames: bool = False,
    has_log: bool = False,
) -> FramePairs:
    """Find the frames of both cameras and pair them.

    Parameters
    ----------
    directory : Path
        The run or fixture directory.
    patterns : (str, str)
        File name or glob of camera 1 and camera 2, relative to `directory`.
    bit_depths : (int, int)
        Bits per pixel of camera 1 and camera 2.
    selections : (Selection, Selection)
        Part of the files that belongs to camera 1 and camera 2.
    skip_bad_frames : bool
        Leave out pairs with a missing or unreadable file instead of refusing the recording. Which
        file is missing is known where both cameras have a file for each frame and number them from
        the same first number.
    has_log : bool
        Whether an encoder log belongs to the frames, so that the advice may include its rows.

    Returns
    -------
    FramePairs

    Raises
    ------
    FrameError
        If frames are missing, unreadable, of different size or type, or not counts of one channel.
    """
    one, two = (
        find_pages(directory, pattern, f"camera{n}", selection)
        for n, (pattern, selection) in enumerate(zip(patterns, selections, strict=True), 1)
    )
    _check_files_differ(one.pages, two.pages)
    if skip_bad_frames:
        _pad_truncated((one, two))
        pad_lost((one, two))

    faults = _name_faults(directory, (one, two))
    if faults and not skip_bad_frames:
        if faults.keys() >= set(range(len(one.pages))):
            raise _nothing_readable(directory, faults)
        raise FrameError(_fault_message(faults))

    # pixels are decoded here only where undecodable frames may be left out: it takes as long as
    # reading the whole recording
    parts = {selection.part for selection in selections}
    if parts == {"odd", "even"} and not faults and len({*one.kinds, *two.kinds}) == 1:
        check_turns(one.pages, two.pages, directory, one.kinds[0].shape)
    _check_pairs(one.pages, two.pages, directory, has_log=has_log)
    if skip_bad_frames:
        faults |= _find_undecodable(directory, (one, two), faults)

    good = [k for k in range(len(one.pages)) if k not in faults]
    if not good:
        raise _nothing_readable(directory, faults)
    rows, columns = _check_kinds((one, two), good, directory)

    # the first pair is decoded here, so that a wrong bit depth is reported before any work
    for camera, (bit_depth, files) in enumerate(zip(bit_depths, (one, two), strict=True), 1):
        counts = read_page(files.pages[good[0]], directory, (rows, columns))
        name = name_page(files.pages[good[0]], directory, camera)
        check_depth(counts, bit_depth=bit_depth, name=name)
        files.warning = _find_time(counts, name)
    two.warning = two.warning or _compare_exposures(one, two)
    # a file that was cut has times of the frames that are left
    known = (files.times for files in (one, two) if files.times is not None)
    return FramePairs(
        directory,
        (tuple(one.pages), tuple(two.pages)),
        (rows, columns),
        bit_depths,
        faults,
        times=next((times for times in known if len(times) == len(one.pages)), None),
        companions=(tuple(one.companions), tuple(two.companions)),
        warnings=(one.warning, two.warning),
        stated_bits=(one.bits, two.bits),
        serials=(one.serial, two.serial),
    )


def _find_time(counts: Counts, name: str) -> str:
    """State the time written over the first pixels of a page; empty if there is none."""
    time = find_stamp(counts)
    if not time:
        return ""
    return (
        f"the first pixels of {name} hold the time {time}, as PCO cameras write it, and no light; "
        "as text it covers 8 rows of 271 pixels. Switch the time stamp off, or choose a region of "
        "interest below it."
    )


def _compare_exposures(one: CameraFiles, two: CameraFiles) -> str:
    """State that two channels of a file are not pairs by their times; empty if they may be."""
    first, second = one.pages[0], two.pages[0]
    apart = two.start - one.start
    channels = first.path == second.path and second.selection.part.startswith("channel")
    if not channels or abs(apart) < _TOGETHER:
        return ""
    order = "later" if apart > 0 else "earlier"
    return (
        f"its frames are {1e3 * abs(apart):.3g} ms {order} than those of camera 1 by the times in "
        f"{first.path.name}, and a pair must be of one laser pulse. Choose the channels of one "
        "exposure."
    )


def _check_kinds(
    cameras: Sequence[CameraFiles], good: Sequence[int], directory: Path
) -> tuple[int, int]:
    """Return the shape of the frames; refuse mixed kinds and values that are no counts."""
    # the most frequent kind is the usual one, so that the odd file is named and not the others
    counted = Counter(files.kinds[k] for files in cameras for k in good)
    usual: FrameKind = counted.most_common(1)[0][0]
    for camera, files in enumerate(cameras, 1):
        for k in good:
            if files.kinds[k] != usual:
                name = name_page(files.pages[k], directory, camera)
                raise FrameError(
                    f"Expected frames of one size and type, {usual}; {name} is {files.kinds[k]}. "
                    "Set the same region of interest and depth for all frames of both cameras, and "
                    "take out previews."
                )

    first = cameras[0].pages[good[0]].name
    if len(usual.shape) != 2 or usual.dtype not in STORED_TYPES:
        colour = f" in {usual.shape[2]} colours" if len(usual.shape) == 3 else ""
        raise FrameError(
            f"Expected grey frames of whole counts; {first} holds {usual.dtype}{colour}. Save the "
            "raw counts of the cameras, one channel each."
        )
    if min(usual.shape) < _SMALLEST:
        shape = describe_shape(usual.shape)
        raise FrameError(
            f"Expected frames of at least {_SMALLEST} x {_SMALLEST} pixels; {first} is {shape}. "
            "Record a larger region of interest."
        )
    rows, columns = usual.shape
    return rows, columns


def _find_undecodable(
    directory: Path, cameras: Sequence[CameraFiles], known: dict[int, str]
) -> dict[int, str]:
    """Frame pairs whose headers are sound and whose pixels cannot be decoded."""
    faults: dict[int, str] = {}
    for camera, files in enumerate(cameras, 1):
        for k, (page, kind) in enumerate(zip(files.pages, files.kinds, strict=True)):
            if k in known or k in faults:
                continue
            try:
                read_page(page, directory, kind.shape)
            except FrameError:
                faults[k] = f"{name_page(page, directory, camera)}: it cannot be decoded"
    return faults


def _check_files_differ(one: Sequence[Page], two: Sequence[Page]) -> None:
    """Refuse cameras that share files without parts that exclude one another."""
    shared = {page.path for page in one} & {page.path for page in two}
    if not shared or may_share_files(one[0].selection, two[0].selection):
        return
    name = next(page.path.name for page in one if page.path in shared)
    raise FrameError(
        f"Expected frames of two cameras; both [camera1] and [camera2] name {name}. Correct files "
        "in one of them. Where one file holds both cameras, give both tables their part, for "
        'example part = "left" and part = "right".'
    )


def _check_pairs(
    one: Sequence[Page], two: Sequence[Page], directory: Path, *, has_log: bool
) -> None:
    """Refuse cameras whose frames do not pair, naming the first frame without a partner."""
    unmatched = _first_unmatched(one, two)
    if unmatched is None:
        return

    camera, page = unmatched
    files = Counter(page.path for page in (one, two)[camera - 1])
    if len(files) > 1 and min(files.values()) > 1:
        names = list_some((f"{path.name} ({count})" for path, count in files.items()), most=3)
        cure = f"camera{camera} has the frames of {names}: name one recording alone as files."
    elif max(len(one), len(two)) > MOST_UNEQUAL * min(len(one), len(two)):
        cure = "Check files of [camera1] and [camera2] first: they hardly name one recording."
    elif is_one_file(one) or is_one_file(two):
        cure = (
            "Export the same frames of both recordings with the camera's software"
            f"{', and take the rows of frames that are left out from the encoder log' * has_log}."
        )
    elif common_numbers((one, two)):
        row = "; its row stays in the encoder log" * has_log
        cure = f"Use --skip-bad-frames to leave it out{row}."
    else:
        cure = (
            "To drop it, put an empty file of its name into the other camera's folder and use "
            "--skip-bad-frames, or take it out of this one"
            f"{', and its row out of the encoder log' * has_log}."
        )
    name = name_page(page, directory, camera)
    raise FrameError(
        "Expected as many frames of camera 2 as of camera 1, pair by pair; camera1 has "
        f"{len(one)}, camera2 has {len(two)}. The first unmatched one is {name}. {cure}"
    )


def _first_unmatched(one: Sequence[Page], two: Sequence[Page]) -> tuple[int, Page] | None:
    """Camera, 1 or 2, and first frame without a partner; None where all frames pair.

    Frames pair by the numbers in their names where both cameras use the same numbers.
    """
    # with equal counts, different numbers are a fault only where most numbers are common
    a, b = frame_numbers(one), frame_numbers(two)
    if len(one) == len(two):
        common = len(set(a) & set(b)) >= len(one) / 2
        if not common or len({first - second for first, second in zip(a, b, strict=True)}) == 1:
            return None  # the cameras number frames differently, or from different first numbers

    # the camera with more frames has the unmatched one
    camera, pages, own, other = (1, one, a, b) if len(one) >= len(two) else (2, two, b, a)
    if not set(own) & set(other):
        return camera, pages[len(other)]
    known = set(other)
    lone = (page for page, number in zip(pages, own, strict=True) if number not in known)

    # the same numbers in another order: one name of the camera differs in more than its number
    odd = (page for page, first, second in zip(pages, own, other, strict=False) if first != second)
    return camera, next(lone, None) or next(odd, pages[-1])


def _pad_truncated(cameras: Sequence[CameraFiles]) -> None:
    """Add the pages that a truncated multi-page file has lost, as unreadable ones."""
    # the other camera shows how many pages there were
    most = max(len(files.pages) for files in cameras)
    for files in cameras:
        last = files.pages[-1]
        is_single_file = last.path == files.pages[0].path
        if len(files.pages) - 1 in files.faults and is_single_file:
            reason = files.faults[len(files.pages) - 1]
            for n in range(len(files.pages), most):
                files.faults[n] = reason
                files.pages.append(Page(last.path, n, selection=last.selection))
                files.kinds.append(UNREADABLE)


def _name_faults(directory: Path, cameras: Sequence[CameraFiles]) -> dict[int, str]:
    """Describe the unreadable pages of each pair, of both cameras, with their file names."""
    faults: dict[int, str] = {}
    for camera, files in enumerate(cameras, 1):
        for k, reason in files.faults.items():
            fault = f"{name_page(files.pages[k], directory, camera)}: {reason}"
            faults[k] = f"{faults[k]}; {fault}" if k in faults else fault
    return faults


def _nothing_readable(directory: Path, faults: dict[int, str]) -> ErlifError:
    """Refusal of a recording without a readable pair."""
    reason = with_advice(faults[min(faults)], "Record them again, or copy the files again.")
    return FrameError(
        f"Expected readable frames in {directory}; every pair has an unreadable file: {reason}"
    )


def _fault_message(faults: dict[int, str]) -> str:
    more = f" ({len(faults) - 1} more are unreadable)" if len(faults) > 1 else ""
    first = faults[min(faults)]
    if first.endswith("."):
        return f"Expected readable frames{more}; {first}"
    return f"Expected readable frames; {with_advice(first + more)}"
