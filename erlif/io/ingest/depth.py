"""The bit depth of a camera by its counts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from erlif.core.errors import FrameError
from erlif.io.ingest.counts import FEW_LEVELS, count_padding
from erlif.io.ingest.images import Page, read_page

# Bit depths of cameras that store 16-bit files; dim frames of such a camera fit fewer bits.
USUAL_DEPTHS = (12, 14, 16)


@dataclass(frozen=True)
class CountsSample:
    """Levels and bit depth of the counts of a sample of pages.

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
    stated: bool


def sample_counts(
    pages: Iterable[tuple[Page, tuple[int, ...]]], directory: Path, stated: int | None
) -> CountsSample | None:
    """Find the bit depth of a camera.

    Parameters
    ----------
    pages : iterable of (Page, tuple of int)
        Images with their shapes. [px]
    directory : Path
        Directory of the run.
    stated : int or None
        Significant bits of a count after the headers.

    Returns
    -------
    CountsSample or None
        None where no page can be read, or all counts are 0.
    """
    highest, used, levels, read, wide = 0, 0, 0, 0, False
    top: Counter[int] = Counter()  # number of pixels at the largest count of a page
    for page, shape in pages:
        try:
            counts = read_page(page, directory, shape)
        except FrameError:
            continue
        most = int(counts.max())
        highest = max(highest, most)
        used |= int(np.bitwise_or.reduce(counts, axis=None))
        levels = max(levels, np.unique(counts).size)
        wide = wide or counts.dtype.itemsize > 1
        top[most] += int((counts == most).sum())
        read += 1
    if not read or not used:
        return None

    # in an image of few levels, low bits that are never set may be chance
    unused = count_padding(used) if levels > FEW_LEVELS else 0

    # dim frames fit fewer bits than the camera has, which its header states
    bits = (highest >> unused).bit_length()
    depth = next(depth for depth in (USUAL_DEPTHS if wide else (8,)) if bits <= depth)
    fits = stated is not None and bits <= stated and not unused
    depth = stated if stated is not None and fits else depth
    full_scale = ((1 << depth) - 1) << unused
    return CountsSample(read, highest, unused, depth, top[full_scale] > 1, fits)
