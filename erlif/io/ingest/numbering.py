"""Numbers in the names of frame files, and which frames they show to be missing."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from erlif.io.ingest.frames import FramePairs
from erlif.io.ingest.images import UNREADABLE, CameraFiles, Page
from erlif.io.ingest.order import number_files

# Ratio of the frames of two cameras above which files are wrong rather than frames lost.
MOST_UNEQUAL = 2

# The last number of a name counts: "2026-11-22_cam1_0007" is frame 7.
_LAST_NUMBER = re.compile(r"([+-]?)(\d+)(?=\D*$)")

# Share of equal steps from number to number, below which others are no gaps.
_USUAL = 0.5


def frame_numbers(pages: Sequence[Page]) -> list[int]:
    """Number of each frame by its file name; its position where names do not distinguish frames."""
    numbers = [number or 0 for number in number_files([page.path for page in pages])]
    return numbers if len(set(numbers)) == len(pages) else list(range(len(pages)))


def has_numbers(pages: Sequence[Page]) -> bool:
    """Whether each frame has a file, in the order of the numbers of the files.

    Examples
    --------
    >>> from pathlib import Path
    >>> has_numbers([Page(Path(name), 0) for name in ("f_1.tif", "f_3.tif")])
    True
    >>> has_numbers([Page(Path("stack.tif"), 0), Page(Path("stack.tif"), 1)])
    False
    """
    found = number_files([page.path for page in pages])
    numbers = [number for number in found if number is not None]
    files = {page.path for page in pages}
    return len(files) == len(numbers) == len(pages) and bool((np.diff(numbers) > 0).all())


def find_missing(numbers: list[int]) -> list[int]:
    """Numbers that are missing in a sequence of equal steps.

    Parameters
    ----------
    numbers : list of int
        In rising order.

    Returns
    -------
    list of int
        Empty where the steps are mostly unlike: the numbers then count something else.

    Examples
    --------
    >>> find_missing([10, 12, 14, 18, 20])
    [16]
    """
    steps = np.diff(numbers)
    if steps.size < 2:
        return []
    step = int(np.median(steps))
    if step < 1 or (steps == step).mean() <= _USUAL or (steps % step).any():
        return []
    return sorted(set(range(numbers[0], numbers[-1], step)) - set(numbers))


def name_lost(page: Page, number: int, *, signed: bool = False) -> Page:
    """The page of a file that is missing, named as that of another frame of the camera.

    Parameters
    ----------
    page : Page
    number : int
    signed : bool
        Whether a hyphen before the number is its sign.

    Examples
    --------
    >>> from pathlib import Path
    >>> name_lost(Page(Path("frame_0001.tif"), 0), 12).name
    'frame_0012.tif'
    >>> name_lost(Page(Path("Img-0020.tif"), 0), 3, signed=True).name
    'Img0003.tif'
    """

    def write(found: re.Match[str]) -> str:
        sign = ("-" if number < 0 else "") if signed else found[1]
        return f"{sign}{abs(number):0{len(found[2])}d}"

    stem = _LAST_NUMBER.sub(write, page.path.stem)
    return replace(page, path=page.path.with_name(stem + page.path.suffix))


def add_lost_pairs(pairs: FramePairs) -> FramePairs:
    """Add the pairs whose numbers neither camera has, as pairs that are left out.

    Parameters
    ----------
    pairs : FramePairs

    Returns
    -------
    FramePairs
        The same where the numbers of the files have no gap.
    """
    one, two = (frame_numbers(pages) for pages in pairs.pages)
    gaps = find_missing(one)
    if not gaps or one != two or not all(has_numbers(pages) for pages in pairs.pages):
        return pairs
    numbers = sorted({*one, *gaps})
    place = {number: k for k, number in enumerate(numbers)}
    known = [dict(zip(one, pages, strict=True)) for pages in pairs.pages]
    first, second = (
        tuple(
            found.get(number) or name_lost(found[one[0]], number, signed=one[0] < 0)
            for number in numbers
        )
        for found in known
    )
    skipped = {place[one[k]]: reason for k, reason in pairs.skipped.items()}
    skipped |= {place[n]: f"neither camera has {first[place[n]].name}" for n in gaps}
    return replace(pairs, pages=(first, second), skipped=skipped)


def pad_lost(cameras: Sequence[CameraFiles]) -> None:
    """Add the frames that one camera alone has, to the other as missing files."""
    numbers = common_numbers([files.pages for files in cameras])
    for files in cameras if numbers else ():
        known = {number: k for k, number in enumerate(frame_numbers(files.pages))}
        faults = {numbers.index(n): files.faults[k] for n, k in known.items() if k in files.faults}
        lost = {k: "the file is missing" for k, n in enumerate(numbers) if n not in known}
        pages, kinds = files.pages, files.kinds
        files.pages = [
            pages[known[n]] if n in known else name_lost(pages[0], n, signed=numbers[0] < 0)
            for n in numbers
        ]
        files.kinds = [kinds[known[n]] if n in known else UNREADABLE for n in numbers]
        files.faults = faults | lost


def common_numbers(cameras: Sequence[Sequence[Page]]) -> list[int]:
    """Numbers of the frames that any camera has; empty where numbers do not show which is missing.

    They do not where a camera may count from another first number, where files hold several
    frames, and where few frames are common.
    """
    one, two = (frame_numbers(pages) for pages in cameras)
    if one[0] != two[0] or not all(has_numbers(pages) for pages in cameras):
        return []
    every, both = {*one, *two}, {*one} & {*two}
    return sorted(every) if len(every) <= MOST_UNEQUAL * len(both) else []
