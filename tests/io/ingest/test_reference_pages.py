"""Dark and flat pages, read one at a time, against what was written."""

import numpy as np
import pytest

from erlif.core.errors import FrameError
from erlif.io.ingest import read_reference_pages

RNG = np.random.default_rng(7)
PAGES = RNG.integers(40, 90, (5, 64, 80), dtype=np.uint16)


def read(directory, pattern="dark.tif", *, bit_depth=12, shape=(64, 80)):
    return read_reference_pages(
        directory, pattern, what="camera2 dark", bit_depth=bit_depth, shape=shape
    )


def test_pages_come_in_the_order_of_the_file(tmp_path, save_pages):
    save_pages(tmp_path / "dark.tif", PAGES)
    np.testing.assert_array_equal(np.stack(list(read(tmp_path))), PAGES)


def test_a_page_is_read_when_it_is_asked_for(tmp_path, save_pages):
    """A recording larger than the memory can be read: the second page may still be changed."""
    save_pages(tmp_path / "dark_1.tif", PAGES[:1])
    save_pages(tmp_path / "dark_2.tif", PAGES[1:2])
    pages = read(tmp_path, "dark_*.tif")
    next(pages)
    save_pages(tmp_path / "dark_2.tif", PAGES[2:3])
    np.testing.assert_array_equal(next(pages), PAGES[2])


def test_a_damaged_page_is_named_before_any_page_is_read(tmp_path, save_pages):
    save_pages(tmp_path / "dark_1.tif", PAGES)
    (tmp_path / "dark_2.tif").write_bytes(b"")
    with pytest.raises(
        FrameError, match=r"readable camera2 dark pages; dark_2\.tif: the file is empty"
    ):
        next(read(tmp_path, "dark_*.tif"))


def test_a_truncated_file_is_named_with_its_first_lost_page(tmp_path, save_pages):
    save_pages(tmp_path / "dark.tif", PAGES)
    whole = (tmp_path / "dark.tif").read_bytes()
    (tmp_path / "dark.tif").write_bytes(whole[: int(0.7 * len(whole))])
    with pytest.raises(FrameError, match=r"dark\.tif\[3\]: the file is truncated"):
        next(read(tmp_path))


@pytest.mark.parametrize("shape", [(64, 79), (80, 64), (32, 40)])
def test_pages_of_another_shape_than_the_frames_are_refused(tmp_path, save_pages, shape):
    save_pages(tmp_path / "dark.tif", PAGES)
    with pytest.raises(FrameError, match=f"{shape[1]} x {shape[0]} pixels.* uint16 of 80 x 64"):
        next(read(tmp_path, shape=shape))


def test_every_page_must_fit_the_bit_depth(tmp_path, save_pages):
    pages = PAGES.copy()
    pages[3, 0, 0] = 4096
    save_pages(tmp_path / "dark.tif", pages)
    found = read(tmp_path)
    for _ in range(3):
        next(found)
    with pytest.raises(FrameError, match=r"dark\.tif\[3\] reaches 4096: bit_depth = 13 fits"):
        next(found)
    assert len(list(read(tmp_path, bit_depth=13))) == 5
