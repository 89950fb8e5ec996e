"""The bit depth of a camera by its counts."""

import numpy as np
import pytest
import tifffile
from scenes.camera_files import random_frames, write_mraw

from erlif.io.ingest.depth import sample_counts
from erlif.io.ingest.images import Page


def graded(highest, *, many=False):
    """Counts of many levels; `many` pixels at the highest one, or a single pixel."""
    counts = np.linspace(3, highest - 5, 64 * 80).astype(np.uint16)
    counts[-40 if many else -1 :] = highest
    return counts.reshape(64, 80)


@pytest.mark.parametrize(
    ("counts", "depth", "unused", "certain"),
    [
        (graded(250).astype(np.uint8), 8, 0, False),
        (graded(900), 12, 0, False),
        (graded(4095, many=True), 12, 0, True),
        (graded(4096), 14, 0, False),
        (graded(65535, many=True), 16, 0, True),
        (graded(4095, many=True) << 4, 12, 4, True),
        (graded(16383) << 2, 14, 2, False),
        (np.full((64, 80), 1024, np.uint16), 12, 0, False),  # too uniform to show padding
    ],
)
def test_the_bit_depth_follows_from_the_largest_counts(tmp_path, counts, depth, unused, certain):
    tifffile.imwrite(tmp_path / "a.tif", counts)
    found = sample_counts([(Page(tmp_path / "a.tif", 0), counts.shape)], tmp_path, None)
    assert (found.bit_depth, found.unused_bits, found.full_scale_seen) == (depth, unused, certain)
    assert found.highest == counts.max()


@pytest.mark.parametrize(("bits", "depth"), [(6, 12), (14, 14)])
def test_counts_above_the_depth_of_the_header_overrule_it(tmp_path, bits, depth):
    frames = random_frames(np.random.default_rng(1), bits=bits)
    path = write_mraw(tmp_path / "a.mraw", frames, stored=16, depth=12)
    pages = [(Page(path, k), frames.shape[1:]) for k in range(len(frames))]
    found = sample_counts(pages, tmp_path, 12)
    assert (found.bit_depth, found.stated) == (depth, bits < 12)
