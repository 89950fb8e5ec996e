"""TIFF files against tifffile, which wrote them."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from erlif.core.errors import FrameError
from erlif.readers import FrameKind
from erlif.readers.tiff import TIFF

GREY = np.random.default_rng(5).integers(0, 4096, (3, 64, 80), dtype=np.uint16)


@pytest.mark.parametrize(
    "options",
    [{}, {"bigtiff": True}, {"byteorder": ">"}, {"compression": "zlib"}, {"tile": (16, 16)}],
    ids=["stack", "big", "big endian", "deflate", "tiles"],
)
def test_each_page_of_a_stack_is_read_in_any_order(tmp_path, options):
    path = tmp_path / "a.bin"
    tifffile.imwrite(path, GREY, photometric="minisblack", **options)
    assert TIFF.recognise(path, path.read_bytes()[:512])
    file = TIFF.open(path)
    assert list(file.kinds) == [FrameKind((64, 80), "uint16")] * 3
    for index in (2, 0, 1):
        np.testing.assert_array_equal(file.read(index), GREY[index])
    file.close()


@pytest.mark.parametrize(
    ("installed", "advice"), [(False, r"pip install 'erlif\[formats\]'"), (True, "uncompressed")]
)
def test_a_missing_decoder_is_named_and_not_advised_twice(tmp_path, monkeypatch, installed, advice):
    """The text is the one of tifffile 2026.3.3 without imagecodecs."""

    def fail(self):
        raise ValueError("<COMPRESSION.ZSTD: 50000> requires the 'imagecodecs' package")

    tifffile.imwrite(tmp_path / "a.tif", GREY, photometric="minisblack", tile=(16, 16))
    monkeypatch.setattr(tifffile.TiffPage, "asarray", fail)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: object() if installed else None)
    file = TIFF.open(tmp_path / "a.tif")
    with pytest.raises(FrameError, match=advice):
        file.read(0)
    file.close()
