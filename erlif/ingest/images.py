"""Image files: their pages, shape and type from the header, their counts."""

from __future__ import annotations

import glob
import math
import os
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tifffile

from erlif.core.arrays import AnyArray, Counts
from erlif.core.errors import FrameError
from erlif.settings import CameraSettings

_TIFF = {".tif", ".tiff"}


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


def natural_key(path: Path) -> list[tuple[int, int, str]]:
    """Sort key that puts frame_2 before frame_10."""
    parts = re.split(r"(\d+)", str(path))
    return [(0, int(part), "") if n % 2 else (1, 0, part) for n, part in enumerate(parts)]


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


def _read_foreign(path: Path) -> list[AnyArray]:
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


def _size(shape: tuple[int, ...]) -> str:
    """Width x height, as cameras are described."""
    return " x ".join(str(n) for n in reversed(shape))
