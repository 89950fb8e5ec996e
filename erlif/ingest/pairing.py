"""Frames of two cameras paired by laser pulse."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from erlif.core.errors import FrameError
from erlif.ingest.images import (
    _UNREADABLE,
    Page,
    _check_depth,
    _find_pages,
    _Kind,
    _read_page,
    _size,
)
from erlif.settings import FixtureSettings, RunSettings


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


def _fault_message(faults: dict[int, str]) -> str:
    more = f" ({len(faults) - 1} more are unreadable)" if len(faults) > 1 else ""
    return f"Expected readable frames; {faults[min(faults)]}{more}. Record it again, or use --skip-bad-frames to leave out this frame pair."
