"""LZW and PackBits against what libtiff, which Pillow includes, has written."""

from __future__ import annotations

import io

import numpy as np
import pytest
import tifffile
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from erlif.core.errors import FrameError
from erlif.io.readers.lzw import decode_lzw, decode_packbits

DECODERS = {"tiff_lzw": decode_lzw, "packbits": decode_packbits}


def compress(content: bytes, name: str) -> bytes:
    """One row of bytes, compressed by libtiff."""
    file = io.BytesIO()
    row = np.frombuffer(content, np.uint8)[None]
    Image.fromarray(row).save(file, "TIFF", compression=name)
    with tifffile.TiffFile(io.BytesIO(file.getvalue())) as tiff:
        (offset,), (length,) = tiff.pages[0].dataoffsets, tiff.pages[0].databytecounts
    return file.getvalue()[offset : offset + length]


RNG = np.random.default_rng(3)
ROWS = {
    "random": RNG.integers(0, 256, 20_000, dtype=np.uint8).tobytes(),
    "frames": RNG.poisson(9, 50_000).astype(np.uint8).tobytes(),
    "black": bytes(60_000),
    "ramp": bytes(range(256)) * 40,
    "one": b"\x07",
    "two": b"\x07\x07",
}


@pytest.mark.parametrize("name", DECODERS)
@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS)
def test_rows_of_libtiff_are_decoded(row, name):
    found = DECODERS[name](compress(row, name), len(row))
    assert found.tobytes() == row


@pytest.mark.parametrize("name", DECODERS)
@given(st.lists(st.tuples(st.binary(min_size=1, max_size=4), st.integers(1, 300)), min_size=1))
@settings(deadline=None, database=None, max_examples=25)
def test_any_repetitions_are_decoded(name, parts):
    row = b"".join(part * count for part, count in parts)
    assert DECODERS[name](compress(row, name), len(row)).tobytes() == row


@pytest.mark.parametrize("name", DECODERS)
def test_a_strip_that_is_too_short_or_too_long_is_refused(name):
    data = compress(ROWS["frames"], name)
    for damaged, size in ((data[: len(data) // 2], 50_000), (b"", 1), (data, 49_990)):
        if damaged is data and name == "tiff_lzw":
            size = 50_010
        with pytest.raises(FrameError, match="a strip of the image is damaged"):
            DECODERS[name](damaged, size)


def test_a_code_before_its_text_is_refused():
    for codes in ((256, 300), (256, 7, 259), (258,)):
        bits = "".join(f"{code:09b}" for code in codes).ljust(80, "0")
        with pytest.raises(FrameError, match="LZW"):
            decode_lzw(int(bits, 2).to_bytes(10), 50)


@pytest.mark.parametrize("decode", DECODERS.values(), ids=DECODERS)
def test_random_bytes_are_decoded_or_refused(decode):
    rng = np.random.default_rng(8)
    for _ in range(300):
        data = rng.integers(0, 256, rng.integers(0, 60), dtype=np.uint8).tobytes()
        try:
            assert decode(data, 40).size == 40
        except FrameError:
            continue
