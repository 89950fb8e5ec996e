"""Pictures against Pillow and OpenCV, which wrote them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from PIL import Image

from erlif.core.errors import FrameError
from erlif.readers import FrameKind, open_frames

GREY = np.random.default_rng(5).integers(0, 65536, (64, 80), dtype=np.uint16)
SMALL = (GREY >> 8).astype(np.uint8)


@pytest.mark.parametrize("counts", [SMALL, GREY], ids=["8 bits", "16 bits"])
@pytest.mark.parametrize("suffix", [".png", ".pgm", ".bmp"])
def test_grey_counts_are_read_as_they_were_written(tmp_path, suffix, counts):
    if suffix == ".bmp" and counts is GREY:
        pytest.skip("BMP has 8 bits")
    path = tmp_path / f"a{suffix}"
    assert cv2.imwrite(str(path), counts)
    file = open_frames(path)
    assert list(file.kinds) == [FrameKind((64, 80), counts.dtype.name)]
    np.testing.assert_array_equal(file.read(0), counts)
    assert file.read(0).dtype == counts.dtype


@pytest.mark.parametrize("suffix", [".jpg", ".gif"])
def test_a_format_that_changes_the_counts_is_refused(tmp_path, suffix):
    Image.fromarray(SMALL).save(tmp_path / f"a{suffix}")
    with pytest.raises(FrameError, match=r"no counts. Save the raw counts as TIFF\."):
        open_frames(tmp_path / f"a{suffix}")


@pytest.mark.parametrize("suffix", [".png", ".bmp"])
def test_a_palette_is_refused(tmp_path, suffix):
    image = Image.fromarray(SMALL).convert("RGB").quantize(64)
    image.save(tmp_path / f"a{suffix}")
    with pytest.raises(FrameError, match="palette"):
        open_frames(tmp_path / f"a{suffix}")


def test_colours_are_a_third_axis_of_the_kind(tmp_path):
    Image.fromarray(np.dstack([SMALL] * 3)).save(tmp_path / "a.png")
    assert list(open_frames(tmp_path / "a.png").kinds) == [FrameKind((64, 80, 3), "uint8")]
