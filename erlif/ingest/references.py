"""Dark and flat pages of a camera."""

from __future__ import annotations

from pathlib import Path

from erlif.core.arrays import Counts
from erlif.core.errors import FrameError
from erlif.ingest.images import Page, _check_depth, _find_pages, _read_page
from erlif.settings import CameraSettings


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
