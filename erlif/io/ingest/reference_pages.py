"""Dark and flat pages of a camera, read one at a time."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from erlif.core.arrays import Counts
from erlif.core.errors import FrameError
from erlif.io.ingest.images import check_depth, find_pages, read_page, with_advice
from erlif.io.ingest.selection import WHOLE, Selection


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

    Parameters
    ----------
    directory : Path
    pattern : str
        File name or glob, relative to `directory`.
    what : str
        Name of the pages in messages, such as "camera1 dark".
    bit_depth : int
        Bits per pixel of the camera.
    shape : (rows, columns)
        Shape of the frames they belong to. [px]
    selection : Selection
        Part of the files that belongs to the camera.

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
    ...     what="camera1 dark", bit_depth=12, shape=(256, 320),
    ... )
    >>> next(pages).shape
    (256, 320)
    """
    # headers of all pages first: a fault in the last one is reported before any work
    found = find_pages(directory, pattern, what, selection)
    if found.faults:
        first = min(found.faults)
        name, reason = found.pages[first].name, found.faults[first]
        raise FrameError(
            f"Expected readable {what} pages; {name}: "
            f"{with_advice(reason, 'Record them again, or take the file out.')}"
        )

    for page in found.pages:
        counts = read_page(page, directory, shape)
        check_depth(counts, bit_depth=bit_depth, name=page.name)
        yield counts
